"""The columns of encounters.csv that are not metrics: participants, place, time and right of way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.encounters.case import Case
from analysis.encounters.finding import Encounter
from analysis.results.origin import CONDITIONS, CONFIGURATION, IDENTITY, Origin
from analysis.tables.column import Column, at_least_0, flag, number, text

_PRIORITY = {"zebra": "ped", "unmarked": "ego"}


@dataclass(frozen=True, slots=True)
class ListedEncounter:
    """One encounter of a case, from which these columns are made."""

    origin: Origin
    case: Case
    index: int

    @property
    def encounter(self) -> Encounter:
        """The encounter itself."""
        return self.case.encounters[self.index]

    @property
    def number(self) -> int:
        """Number within the run, from 1."""
        return self.index + 1

    @property
    def start(self) -> float:
        """Time at which the encounter begins [s]."""
        return float(self.case.grid.time[self.encounter.first])

    @property
    def end(self) -> float:
        """Time at which the encounter ends [s]."""
        return float(self.case.grid.time[self.encounter.last])

    @property
    def entered(self) -> bool:
        """Whether the pedestrian did more than wait."""
        return bool(self.case.entered[self.index])

    @property
    def pedestrian_radius(self) -> float:
        """Radius of the pedestrian's disc [m]."""
        return 0.5 * self.encounter.person.width

    @property
    def priority(self) -> str:
        """The party with the right of way."""
        one = self.encounter
        return _PRIORITY.get(one.crossing_kind, "none") if one.crossing_id else "ego"

    @property
    def first_user(self) -> str:
        """The party that left the conflict area first; a party still inside counts as leaving last."""
        area = self.encounter.area
        if area is None:
            return "none"
        leaves_ego, leaves_person = np.nan_to_num([area.ego.leave, area.person.leave], nan=np.inf)
        if leaves_ego == leaves_person:
            return "ego" if area.ego.enter <= area.person.enter else "ped"
        return "ego" if leaves_ego < leaves_person else "ped"

    @property
    def conflict_type(self) -> str:
        """Turning if the ego turns before or inside the area; otherwise by the angle between the paths."""
        one, limits = self.encounter, self.case.thresholds
        first, last = one.first - one.ego.first, one.last - one.ego.first
        if one.area is not None:
            first, last = min(first, one.area.ego.first), one.area.ego.last
        heading = one.ego.heading[first : last + 1]
        if np.ptp(heading) > np.radians(limits.turning_angle_deg):
            return "turning"
        if one.area is None:  # listed because of a crossing
            return "crossing"
        person = slice(one.area.person.first, one.area.person.last + 1)
        x, y = one.person.x[person], one.person.y[person]
        dx, dy = float(x[-1] - x[0]), float(y[-1] - y[0])
        if np.hypot(dx, dy) < 1e-6:
            return "crossing"
        across = abs(np.sin(np.arctan2(dy, dx) - heading[-1]))
        longitudinal = across < np.sin(np.radians(limits.longitudinal_angle_deg))
        return "longitudinal" if longitudinal else "crossing"


COLUMNS = (
    *IDENTITY,
    Column(
        "encounter_id", "integer", "1", "number within the run, from 1", "number", minimum=1.0, required=True
    ),
    *CONFIGURATION,
    text("ego_id", "ego vehicle", source="encounter.ego.name", required=True),
    text("ped_id", "pedestrian", source="encounter.person.name", required=True),
    text("ped_type", "SUMO type of the pedestrian", source="encounter.person.kind"),
    text(
        "crossing_id",
        "crossing that the pedestrian is on or waits for; empty away from crossings",
        source="encounter.crossing_id",
    ),
    text(
        "crossing_type",
        "kind of that crossing",
        *("zebra", "unmarked", "signal"),
        source="encounter.crossing_kind",
    ),
    text(
        "priority",
        "who has priority there: ped at a zebra, ego at an unmarked crossing and on the open road, "
        "none where signals decide or the crossing is not on the map",
        *("ped", "ego", "none"),
        source="priority",
        required=True,
    ),
    text(
        "passage_id",
        "ego, crossing and number of the passage; groups encounters",
        source="encounter.passage_id",
    ),
    number(
        "t_start_s",
        "s",
        "both are within the encounter range from here on",
        source="start",
        required=True,
    ),
    number("t_end_s", "s", "one has left that range, or the recording ends", source="end", required=True),
    flag(
        "entered",
        "the pedestrian was on the crossing or in the ego's path, not only waiting",
        source="entered",
        required=True,
    ),
    flag(
        "censored",
        "the recording ended before the encounter was over",
        source="encounter.censored",
        required=True,
    ),
    text(
        "conflict_type",
        "geometry",
        *("crossing", "longitudinal", "turning"),
        source="conflict_type",
        required=True,
    ),
    text(
        "first_user",
        "who left the conflict area first",
        *("ego", "ped", "none"),
        source="first_user",
        required=True,
    ),
    at_least_0(
        "ego_length_m", "m", "length of the ego's rectangle", source="encounter.ego.length", required=True
    ),
    at_least_0(
        "ego_width_m", "m", "width of the ego's rectangle", source="encounter.ego.width", required=True
    ),
    at_least_0(
        "ped_radius_m", "m", "radius of the pedestrian's disc", source="pedestrian_radius", required=True
    ),
    number("x_conflict_m", "m", "centre of the conflict area, world frame", source="encounter.area.x"),
    number("y_conflict_m", "m", "centre of the conflict area, world frame", source="encounter.area.y"),
    *CONDITIONS,
)
