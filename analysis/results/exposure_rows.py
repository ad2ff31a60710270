"""crossing_exposure.csv: how many road users used each crossing of a run, whether they met or not.

The numbers of conflicts in traffic_encounters.csv are divided by this exposure.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field
from operator import itemgetter

import numpy as np

from analysis.arrays import FloatArray
from analysis.encounters.case import Case
from analysis.encounters.crossing_walks import CrossingWalk, at_crossing, delay, walks
from analysis.polylines import arc_lengths
from analysis.recording.reading import Area, RecordedRun
from analysis.results.origin import CONFIGURATION, IDENTITY, Origin
from analysis.tables.cells import Row, plain
from analysis.tables.column import Table, at_least_0, count, flag, number, row_of, text

BICYCLE = "bicycle"


@dataclass(slots=True)
class CrossingUse:
    """One crossing of a run, from which a row is made."""

    origin: Origin
    area: Area
    observed: float
    """Simulated time that was recorded [s]."""
    passed: list[tuple[bool, str, float]] = field(default_factory=list)
    """For each motor vehicle: whether it is not an ego, its name, and its speed at the crossing [m/s]."""
    cyclists: int = 0
    red: int = 0
    pedestrians: int = 0
    waits: list[tuple[str, float]] = field(default_factory=list)
    """Names and delays of the pedestrians whose delay is defined [s]."""

    @property
    def middle(self) -> FloatArray:
        """Middle of the crossing's axis [m]."""
        return np.asarray(0.5 * (self.area.shape[0] + self.area.shape[-1]))

    @property
    def x(self) -> float:
        """x coordinate of the middle, in the world frame [m]."""
        return float(self.middle[0])

    @property
    def y(self) -> float:
        """y coordinate of the middle, in the world frame [m]."""
        return float(self.middle[1])

    @property
    def length(self) -> float:
        """Length from kerb to kerb [m]."""
        return float(arc_lengths(self.area.shape)[-1])

    @property
    def speeds(self) -> list[float]:
        """Speeds of motor vehicles, egos first and then by name, so that sums do not depend on the parts."""
        return [speed for _, _, speed in sorted(self.passed, key=itemgetter(0, 1))]

    @property
    def vehicles(self) -> int:
        """Number of motor vehicles that passed over the crossing."""
        return len(self.passed)

    @property
    def mean_speed(self) -> float | None:
        """Mean speed of motor vehicles; ``None`` without any [m/s]."""
        return float(np.mean(self.speeds)) if self.passed else None

    @property
    def high_speed(self) -> float | None:
        """85th percentile of the speeds of motor vehicles; ``None`` without any [m/s]."""
        return float(np.percentile(self.speeds, 85.0)) if self.passed else None

    @property
    def delayed(self) -> int:
        """Number of pedestrians whose delay is defined."""
        return len(self.waits)

    @property
    def delay(self) -> float:
        """Sum of their delays [s]."""
        return float(sum(lost for _, lost in sorted(self.waits, key=itemgetter(0))))


EXPOSURE = Table(
    "crossing_exposure",
    "One row for each crossing of a run that records everybody: who used it",
    (
        *IDENTITY,
        text("crossing_id", "crossing", source="area.name", required=True),
        *CONFIGURATION,
        text("crossing_type", "kind", "zebra", "unmarked", "signal", source="area.crossing_kind"),
        count("lanes", "lanes for cars that it crosses", source="area.facts.lanes"),
        flag("refuge", "it ends on an island between lanes", source="area.facts.refuge"),
        at_least_0("length_m", "m", "from kerb to kerb", source="length", required=True),
        at_least_0("speed_limit_mps", "m/s", "highest of those lanes", source="area.facts.speed_limit_mps"),
        number("x_m", "m", "middle, world frame", source="x", required=True),
        number("y_m", "m", "middle, world frame", source="y", required=True),
        number(
            "longitude_deg",
            "deg",
            "middle, WGS 84; empty without a projection",
            source="area.facts.longitude_deg",
        ),
        number("latitude_deg", "deg", "the same", source="area.facts.latitude_deg"),
        at_least_0("observed_s", "s", "simulated time that was recorded", source="observed", required=True),
        count("n_pedestrians", "walks of pedestrians over it", source="pedestrians", required=True),
        count("n_vehicles", "motor vehicles over it", source="vehicles", required=True),
        count("n_cyclists", "bicycles over it", source="cyclists", required=True),
        count("n_red_light_walkers", "pedestrians who began on red", source="red", required=True),
        count("n_ped_delay_defined", "pedestrians with a delay", source="delayed", required=True),
        at_least_0("ped_delay_sum_s", "s", "sum of their delays", source="delay", required=True),
        at_least_0("vehicle_speed_mean_mps", "m/s", "mean, of motor vehicles there", source="mean_speed"),
        at_least_0("vehicle_speed_p85_mps", "m/s", "85th percentile of it", source="high_speed"),
    ),
    ("run_id", "crossing_id"),
)


class Exposures:
    """The use of a run's crossings, added up over the parts of its recording.

    Parameters
    ----------
    run : RecordedRun
        The run, for its crossings.
    classes : Mapping
        SUMO's vehicle class of each vehicle.
    """

    def __init__(self, run: RecordedRun, classes: Mapping[str, str]) -> None:
        origin, self._classes = Origin(run.meta), classes
        observed = float(run.meta.get("duration_s") or 0.0)
        self._uses = {area.name: CrossingUse(origin, area, observed) for area in run.crossings()}

    def add_egos(self, case: Case) -> None:
        """Add the vehicles that were egos, all at once or in parts."""
        self._add_vehicles(case, None)

    def add(self, others: Case, own: Set[str]) -> None:
        """Add the pedestrians of a part, and the vehicles that belong to it.

        Parameters
        ----------
        others : Case
            The part, with vehicles and with pedestrians who are in no other part.
        own : Set
            Names of the vehicles that belong to this part.
        """
        self._add_vehicles(others, own)
        for walk in _all_walks(others):
            _add(self._uses[walk.crossing_id], walk, others)

    def rows(self) -> Sequence[Row]:
        """Return the rows of crossing_exposure.csv, in the order of the map."""
        return [plain(EXPOSURE, row_of(EXPOSURE.columns, use)) for use in self._uses.values()]

    def _add_vehicles(self, case: Case, own: Set[str] | None) -> None:
        for (vehicle, crossing), passages in case.traversals.items():
            if own is not None and vehicle not in own:
                continue
            use = self._uses[crossing]
            for one in passages:
                if self._classes.get(vehicle) == BICYCLE:
                    use.cyclists += 1
                else:
                    use.passed.append((own is not None, vehicle, float(one.track.speed[one.visit.first])))


def _all_walks(case: Case) -> list[CrossingWalk]:
    known = {area.name for area in case.run.crossings()}
    found = [walk for person in case.persons for walk in walks(person, case.run.neighbours)]
    return [walk for walk in found if walk.crossing_id in known]


def _add(use: CrossingUse, walk: CrossingWalk, case: Case) -> None:
    use.pedestrians += 1
    use.red += walk.red
    inside = at_crossing(walk.person, case.run.neighbours, walk.crossing_id, "waiting", "crossing")
    lost = delay(walk.person, inside, walk.since, walk.last, case.grid, case.thresholds)
    if np.isfinite(lost):
        use.waits.append((walk.person.name, lost))
