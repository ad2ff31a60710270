"""How often an ego stood for too long with a free road.

Stretches longer than deadlock_s at or below standing_speed_mps in which no vehicle was ever within
deadlock_free_gap_m ahead; within deadlock_signal_range_m of a crossing with signals, where a red phase
may last, longer than deadlock_signal_s. deadlock_where names each ego with the beginning, the end and the
place: the nearest crossing within deadlock_signal_range_m, otherwise the lane.

Undefined: never. Steps without a recorded gap count as free.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from operator import attrgetter

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.polylines import distance_from
from analysis.recording.tracks import Track
from analysis.stretches import stretches
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
RUN_COLUMNS = (
    column.count("deadlock", "times that an ego stood for too long with a free road", required=True),
    column.text("deadlock_where", "which ego, from when to when, and where; empty without one"),
)

_STAND = re.compile(
    r"ego (?P<ego>.*), (?P<start>[\d.]+) to (?P<end>[\d.]+) s, (?P<place>(at crossing|on lane) .*)"
)


@dataclass(frozen=True, slots=True)
class Stand:
    """One ego that deadlock_where names, with the beginning, the end and the place of its stand."""

    ego_id: str
    start_s: float
    end_s: float
    place: str

    def __str__(self) -> str:
        return f"ego {self.ego_id}, {self.start_s:.1f} to {self.end_s:.1f} s, {self.place}"


def first_stand(told: str) -> Stand | None:
    """Return the first ego named in a text of deadlock_where; ``None`` if the text cannot be read.

    Examples
    --------
    >>> first_stand("ego a, 12.0 to 90.5 s, at crossing :J_c0; ego b, 13.0 to 91.0 s, on lane in_0")
    Stand(ego_id='a', start_s=12.0, end_s=90.5, place='at crossing :J_c0')
    """
    found = _STAND.fullmatch(told.split("; ego ")[0])
    return found and Stand(found["ego"], float(found["start"]), float(found["end"]), found["place"])


def collect_rides(case: Case) -> Values:
    """Return the stretches in which egos of a part of the run stood for too long."""
    return {"stands": [one for track in case.egos for one in _stands(case, track)]}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of stretches and their description, sorted by ego and time."""
    stands = sorted(columns["stands"], key=attrgetter("ego_id", "start_s"))
    return {"deadlock": len(stands), "deadlock_where": "; ".join(map(str, stands)) or None}


def _stands(case: Case, track: Track) -> Iterator[Stand]:
    limits = case.thresholds
    number = case.run.egos.numbers
    rows = track.rows[:: case.grid.factor]
    time, gap = number["time_s"][rows], number["gap_ahead_m"][rows]
    for first, last in stretches(number["speed_mps"][rows] <= limits.standing_speed_mps):
        lasted = time[last] - time[first]
        if lasted <= limits.deadlock_s or (gap[first : last + 1] < limits.deadlock_free_gap_m).any():
            continue
        x, y = track.x[first * case.grid.factor], track.y[first * case.grid.factor]
        near = {
            area.name: (distance_from(area.shape, x, y), area.crossing_kind) for area in case.run.crossings()
        }
        near = {name: one for name, one in near.items() if one[0] < limits.deadlock_signal_range_m}
        if any(kind == "signal" for _, kind in near.values()) and lasted <= limits.deadlock_signal_s:
            continue
        lane = case.run.egos.texts["lane"].at(int(rows[first]))
        place = f"at crossing {min(near, key=lambda name: near[name])}" if near else f"on lane {lane or '?'}"
        yield Stand(track.name, float(time[first]), float(time[last]), place)
