"""traffic_encounters.csv: all encounters of vehicles, egos or not, with pedestrians near crossings.

The columns are those of encounters.csv except the ones that need a controller. Where a name says *ego*, the
vehicle is meant. An ego has the same values as in encounters.csv.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

import numpy as np

from analysis.arrays import IntArray
from analysis.encounters.case import Case
from analysis.encounters.finding import Encounter
from analysis.results import encounter_description
from analysis.results.column_order import ENCOUNTERS, in_order
from analysis.results.encounter_description import ListedEncounter
from analysis.results.metric_catalog import Metric, find_metrics
from analysis.results.origin import IDENTITY, Origin
from analysis.results.rows import of_encounters
from analysis.tables.cells import Row, plain
from analysis.tables.column import Column, Table, count, flag, row_of, text

SUMO = "sumo"
"""Controller of vehicles that are not egos, unless the run names another driver for them."""


@dataclass(frozen=True, slots=True)
class ListedTraffic(ListedEncounter):
    """One encounter of a vehicle, from which a row is made."""

    is_ego: bool
    vehicle_class: str
    before: int
    """Number of encounters of egos that were added before those of this case."""

    @property
    def controller(self) -> str:
        """Name of the vehicle's driver."""
        if self.is_ego:
            return str(self.origin.meta["controller"])
        return str(self.origin.meta.get("traffic_driver", SUMO))

    @property
    def number_of_ego(self) -> int | None:
        """Number of an ego's encounter in the order of adding; ``Listing.number_egos`` makes it final."""
        return self.before + self.number if self.is_ego else None


_NUMBER = count("traffic_encounter_id", "number within this table and run, from 1", required=True)
_OF_VEHICLE = (
    text("vehicle_id", "vehicle", source="encounter.ego.name", required=True),
    text("vehicle_class", "SUMO's class of it", source="vehicle_class"),
    flag("is_ego", "the vehicle is an ego", source="is_ego", required=True),
    text(
        "controller",
        "who drives it; sumo for SUMO's own driver, tracks for a real one",
        source="controller",
        required=True,
    ),
    count("encounter_id", "of an ego: number in encounters.csv", source="number_of_ego"),
)
_LEFT_OUT = ("encounter_id", "ego_id", "actuation", "sensing", *(column.name for column in IDENTITY))
_DESCRIPTION = (
    *IDENTITY,
    *_OF_VEHICLE,
    *(column for column in encounter_description.COLUMNS if column.name not in _LEFT_OUT),
)


def _metrics() -> tuple[Metric, ...]:
    return tuple(metric for metric in find_metrics() if metric.columns and not metric.of_controller)


def _columns() -> tuple[Column, ...]:
    measured = tuple(column for metric in _metrics() for column in metric.columns)
    first = [column.name for column in (*IDENTITY, _NUMBER, *_OF_VEHICLE)]
    others = [name for name in ENCOUNTERS.split() if name not in first]
    return in_order((_NUMBER, *_DESCRIPTION, *measured), " ".join((*first, *others)))


TRAFFIC_ENCOUNTERS = Table(
    "traffic_encounters",
    "One row for each encounter of a vehicle and a pedestrian near crossings; where a name says ego, the "
    "vehicle is meant",
    _columns(),
    ("run_id", "traffic_encounter_id"),
)


class Listing:
    """The rows of traffic_encounters.csv in the order of their start, over the parts of a recording.

    Parameters
    ----------
    classes : Mapping
        SUMO's vehicle class of each vehicle.
    """

    def __init__(self, classes: Mapping[str, str]) -> None:
        self._classes, self._number, self._of_egos = classes, 0, 0
        self._waiting: list[dict[str, Any]] = []

    def add_egos(self, case: Case) -> None:
        """Add the encounters of a part's egos that would also count for other vehicles."""
        self._waiting += _rows(case, True, self._classes, self._of_egos)
        self._of_egos += len(case)

    def number_egos(self, order: IntArray) -> None:
        """Number the egos' encounters as in encounters.csv, after all were added; ``order`` counts from 0."""
        numbers = np.argsort(order) + 1
        for row in self._waiting:
            row["encounter_id"] = int(numbers[row["encounter_id"] - 1])

    def before(self, time: float) -> Iterator[Row]:
        """Yield the rows that begin before ``time`` [s] and have not been yielded yet."""
        ready = sorted((row for row in self._waiting if row["t_start_s"] < time), key=_PLACE)
        self._waiting = [row for row in self._waiting if row["t_start_s"] >= time]
        for row in ready:
            self._number += 1
            yield plain(TRAFFIC_ENCOUNTERS, {**row, "traffic_encounter_id": self._number})

    def add(self, others: Case) -> None:
        """Add the encounters of other vehicles."""
        self._waiting += _rows(others, False, self._classes)


_PLACE = itemgetter("t_start_s", "vehicle_id", "ped_id")


def _rows(case: Case, is_ego: bool, classes: Mapping[str, str], before: int = 0) -> Iterator[dict[str, Any]]:
    origin = Origin(case.run.meta)
    measured: dict[str, Any] = {}
    for metric in _metrics():
        measured.update(of_encounters(metric, case))
    for index, one in enumerate(case.encounters):
        if _counts(one, case):
            listed = ListedTraffic(origin, case, index, is_ego, classes.get(one.ego.name, ""), before)
            yield {
                **row_of(_DESCRIPTION, listed),
                **{name: values[index] for name, values in measured.items()},
            }


def _counts(one: Encounter, case: Case) -> bool:
    """Return whether the vehicle passed the pedestrian's path shortly before or after, or their crossing."""
    soon = one.area is not None and one.area.time_between <= case.thresholds.traffic_pairing_s
    return soon or one.traversal is not None
