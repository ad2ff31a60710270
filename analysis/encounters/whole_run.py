"""The data kept of a run that was judged part by part, from which the numbers of the run are computed."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from analysis.arrays import FloatArray, IntArray
from analysis.encounters import finding, vehicle_conflicts, vehicle_overlaps
from analysis.encounters.case import Case
from analysis.encounters.vehicle_conflicts import VehicleConflict
from analysis.encounters.vehicle_overlaps import VehicleOverlap
from analysis.recording.reading import RecordedRun
from analysis.thresholds import Thresholds


class Met(NamedTuple):
    """Who met whom in an encounter, and where."""

    place: tuple[int, str, str, int]
    """Key by which the encounters of a run are sorted."""
    ego_id: str
    person_id: str
    crossing_id: str
    """Empty away from crossings."""
    passage_id: str
    """Groups encounters by passage; empty if the ego did not pass the crossing."""
    entered: bool
    """Whether the pedestrian was on the crossing or in the ego's path, rather than only waiting."""


@dataclass(frozen=True, slots=True)
class Steps:
    """One value for each recorded row of the egos; see :class:`analysis.recording.ego_steps.EgoSteps`."""

    duration: FloatArray
    distance: FloatArray
    jerk: FloatArray
    deceleration: FloatArray


@dataclass(frozen=True, slots=True)
class WholeRun:
    """A recorded run without its tracks."""

    run: RecordedRun
    """The run without the tables of what was near its egos and what they knew of it."""
    thresholds: Thresholds
    steps: Steps
    encounters: Sequence[Met]
    near: IntArray
    """Rows of the egos during some encounter, ascending, each once."""
    overlaps: Sequence[VehicleOverlap]
    vehicle_conflicts: Sequence[VehicleConflict]
    pedestrian_widths: frozenset[float]
    """[m]."""
    ego_sizes: frozenset[tuple[float, float]]
    """Lengths and widths [m]."""

    @property
    def egos(self) -> Set[str]:
        """Names of the egos."""
        return frozenset(self.run.egos.texts["ego_id"].names)


class Gathering:
    """Assembles a whole run from its parts.

    Parameters
    ----------
    run : RecordedRun
        As :class:`analysis.recording.rides.Rides` gives it.
    thresholds : Thresholds
    """

    def __init__(self, run: RecordedRun, thresholds: Thresholds) -> None:
        count = len(run.egos)
        self._run, self._thresholds = run, thresholds
        self._steps = Steps(
            np.zeros(count),
            np.zeros(count),
            np.full(count, np.nan),
            np.maximum(-run.egos.numbers["acceleration_mps2"], 0.0),
        )
        self._met: list[Met] = []
        self._near: list[IntArray] = [np.zeros(0, dtype=np.int64)]
        self._overlaps: list[VehicleOverlap] = []
        self._conflicts: list[VehicleConflict] = []
        self._widths: set[float] = set()
        self._sizes: set[tuple[float, float]] = set()

    def add_rides(self, case: Case, rows: IntArray) -> None:
        """Add the rides of a part, whose egos have these rows of all egos."""
        for name in ("duration", "distance", "jerk"):
            getattr(self._steps, name)[rows] = getattr(case.steps, name)
        self._overlaps += case.overlaps
        self._conflicts += case.vehicle_conflicts
        self._sizes |= {(track.length, track.width) for track in case.egos}

    def add_encounters(self, case: Case, rows: IntArray) -> None:
        """Add the encounters of a case of a part, whose egos have these rows of all egos."""
        self._met += [_met(case, index) for index in range(len(case))]
        self._near.append(np.unique(rows[np.concatenate([*case.ego_rows, self._near[0]])]))
        self._widths |= {track.width for track in case.persons}

    def order(self) -> IntArray:
        """Return the numbers of the encounters (from 0, as they were added) in the order of the run."""
        return np.array(sorted(range(len(self._met)), key=lambda index: self._met[index].place), np.int64)

    def whole(self) -> WholeRun:
        """Return the run; all its parts must have been added."""
        return WholeRun(
            run=self._run,
            thresholds=self._thresholds,
            steps=self._steps,
            encounters=[self._met[index] for index in self.order().tolist()],
            near=np.unique(np.concatenate(self._near)),
            overlaps=vehicle_overlaps.in_order(self._overlaps),
            vehicle_conflicts=vehicle_conflicts.in_order(self._conflicts),
            pedestrian_widths=frozenset(self._widths),
            ego_sizes=frozenset(self._sizes),
        )


def _met(case: Case, index: int) -> Met:
    one = case.encounters[index]
    return Met(
        place=finding.place_in_run(one),
        ego_id=one.ego.name,
        person_id=one.person.name,
        crossing_id=one.crossing_id,
        passage_id="" if one.traversal is None else one.passage_id,
        entered=bool(case.entered[index]),
    )
