"""Infers which recorded signal belongs to which movement of a junction, from when vehicles stop and go.

The dataset numbers its signals without their positions. A movement is all lanes of an approach that turn the
same way. Its signal is that one of those with yellow phases which agrees best with its vehicles: it is not
red when they pass the stop line, and not green while they stand there.
"""

from __future__ import annotations

import gzip
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
import pandas as pd

from analysis.files import write_text
from analysis.trajectories.table import PEDESTRIAN
from cosim.tracks.judging import OnNetwork

STOP, READY, GREEN, YELLOW = 3, 4, 5, 7
"""Recorded states, numbered as in SAE J2735; the dataset does not say so, but the agreement confirms it."""
LEAST_AGREEMENT, LEAST_PASSAGES = 0.95, 5
"""Smallest agreement and number of passages; below either, a movement has no known signal."""
STANDING_MPS, FROM_LINE_M = 0.3, 8.0
"""Vehicles slower than this [m/s] whose front is this near to the stop line [m] are first in the queue."""
LOOK_S, AHEAD_S = 0.5, 4.0
Movement = tuple[str, str]
"""Edge of the approach, and SUMO's direction."""


@dataclass(frozen=True, slots=True)
class Inferred:
    """Inferred signal of a movement."""

    movement: Movement
    passages: int
    standing: int
    signal: int
    on_green: float
    """Share of passages on green, on yellow, or on red with yellow."""
    not_on_green: float
    """Share of the instants of standing vehicles at which the signal is not green."""

    @property
    def agreement(self) -> float:
        """Mean of the two shares."""
        return 0.5 * (self.on_green + self.not_on_green)

    @property
    def known(self) -> bool:
        """Whether the evidence suffices to give the movement this signal."""
        return self.passages >= LEAST_PASSAGES and self.agreement >= LEAST_AGREEMENT


def read_states(archive: Path) -> pd.DataFrame:
    """Return the states of the signals: one row per second of the recording, one column per signal."""
    with zipfile.ZipFile(archive) as files:
        (name,) = (one for one in files.namelist() if "/traffic_lights/" in one and one.endswith(".csv"))
        table = pd.read_csv(files.open(name))
    stamps = pd.to_datetime(table["timestamp"], utc=True, format="ISO8601")
    table["time_s"] = (stamps - stamps.min().floor("s")).dt.total_seconds()
    return table.pivot(index="time_s", columns="id", values="state").sort_index()


def infer(found: OnNetwork, states: pd.DataFrame) -> list[Inferred]:
    """Return the best signal of each movement that vehicles made, sorted by movement."""
    passed, stood = observed(found)
    best = []
    for movement, times in sorted(passed.items()):
        waits = stood.get(movement, [])
        candidates = []
        for number in map(int, states.columns[(states == YELLOW).any()]):
            # States are recorded once a second, so that some vehicles pass while red and yellow is still
            # recorded.
            green = np.isin(_at(states, number, times), (GREEN, YELLOW, READY))
            red = _at(states, number, waits) != GREEN
            # If no vehicle stood there, half of the agreement is unknown.
            shares = float(green.mean()), float(red.mean()) if len(waits) else 0.5
            candidates.append(Inferred(movement, len(times), len(waits), number, *shares))
        best.append(max(candidates, key=lambda one: (one.agreement, -one.signal)))
    return best


def observed(found: OnNetwork) -> tuple[dict[Movement, list[float]], dict[Movement, list[float]]]:
    """Return when vehicles passed each movement's stop line, and when they stood first in its queue [s]."""
    frame, lanes = found.placed.frame, found.network.lanes
    every = max(1, round(LOOK_S / found.step_s))
    passed: dict[Movement, list[float]] = {}
    stood: dict[Movement, list[float]] = {}
    for _, track in frame[~frame["kind"].isin([PEDESTRIAN, "bicycle"])].groupby("id", sort=True):
        made = movement_of(track, found)
        if made is None:
            continue
        at, movement = made
        passed.setdefault(movement, []).append(float(track["time_s"].iloc[at]))
        front = track["along_m"].to_numpy() + 0.5 * float(track["length_m"].iloc[0])
        places, speed, time = (track[name].to_numpy() for name in ("place", "speed_mps", "time_s"))
        for row in range(0, at, every):
            lane = lanes.get(places[row])
            if lane is None or lane.edge != movement[0] or speed[row] >= STANDING_MPS:
                continue
            if lane.shape_length - front[row] < FROM_LINE_M:
                stood.setdefault(movement, []).append(float(time[row]))
    return passed, stood


def movement_of(track: pd.DataFrame, found: OnNetwork) -> tuple[int, Movement] | None:
    """Return the sample at which a vehicle passed its first signal, and its movement; ``None`` for none."""
    signalled, lanes = _signalled(found), found.network.lanes
    places = track["place"].to_list()
    for row in range(1, len(places)):
        before = lanes.get(places[row - 1])
        if before is None or before.internal or places[row] not in signalled:
            continue
        # Paths overlap where they begin, so the direction of most of the following samples counts.
        after = places[row : row + int(AHEAD_S / found.step_s)]
        movements = [signalled[one].movement for one in after if one in signalled]
        directions = [direction for edge, direction in movements if edge == before.edge]
        if directions:
            return row, (before.edge, max(sorted(set(directions)), key=directions.count))
    return None


@dataclass(frozen=True, slots=True)
class _Link:
    movement: Movement
    index: int


def _signalled(found: OnNetwork) -> Mapping[str, _Link]:
    """Return the connections with a signal, by their first lane inside the junction."""
    lanes = found.network.lanes
    return {
        one.via[0]: _Link((lanes[one.source].edge, one.direction), one.signal_index)
        for group in found.network.connections.values()
        for one in group
        if one.signal and one.via and not lanes[one.source].internal
    }


def _at(states: pd.DataFrame, number: int, times: Sequence[float]) -> np.ndarray:
    rows = np.searchsorted(states.index.to_numpy(), np.asarray(times), side="right") - 1
    return states[number].to_numpy()[np.clip(rows, 0, len(states) - 1)]


def write_program(
    path: Path,
    found: OnNetwork,
    inferred: Sequence[Inferred],
    states: pd.DataFrame,
    span: tuple[float, float],
    begin_s: float,
) -> Path:
    """Write the recorded phases as a program of SUMO's traffic light, and return the file.

    Movements without a known signal give way. So do crossings, because recorded people obey no signal.

    Parameters
    ----------
    path
    found
    inferred
    states
    span
        Beginning and end of the part of the recording [s].
    begin_s
        Simulated time at which this part begins [s].
    """
    known = {one.movement: one.signal for one in inferred if one.known}
    light, letters = _green_letters(found.location.path)
    links: dict[int, int] = {}
    for one in _signalled(found).values():
        if one.movement in known:
            links[one.index] = known[one.movement]
    phases: list[tuple[int, str]] = []
    for second in range(int(span[0]), int(np.ceil(span[1])) + 1):
        state = "".join(
            _letter(int(_at(states, links[at], [float(second) + 0.5])[0]), green) if at in links else "o"
            for at, green in enumerate(letters)
        )
        if phases and phases[-1][1] == state:
            phases[-1] = phases[-1][0] + 1, state
        else:
            phases.append((1, state))
    lines = [f'        <phase duration="{count}" state={quoteattr(state)}/>' for count, state in phases]
    head = f'    <tlLogic id={quoteattr(light)} programID="recorded" type="static" offset="{begin_s:g}">'
    return write_text(path, "\n".join(["<additional>", head, *lines, "    </tlLogic>", "</additional>", ""]))


def _letter(state: int, green: str) -> str:
    return {GREEN: green, YELLOW: "y", READY: "u"}.get(state, "r")


def _green_letters(net_file: Path) -> tuple[str, list[str]]:
    """Return the traffic light, and for each link its letter of green: ``G`` with priority, ``g`` without."""
    opened = gzip.open if net_file.suffix == ".gz" else open
    with opened(net_file) as file:
        root = ElementTree.parse(file).getroot()
    (logic,) = root.findall("tlLogic")
    states = [phase.get("state", "") for phase in logic.iter("phase")]
    greens = [{letters for letters in column if letters in "gG"} for column in zip(*states, strict=True)]
    return logic.get("id", ""), ["G" if one == {"G"} else "g" for one in greens]
