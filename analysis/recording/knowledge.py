"""An ego's knowledge of pedestrians and its age; recorded only if the ego's sensing was not perfect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray, FloatArray
from analysis.recording.reading import RecordedRun

_LONGEST_GAP_STEPS = 2.5
_PLAN_INTERVAL_S = 0.1
"""Shortest interval at which egos look [s]."""


@dataclass(frozen=True, slots=True)
class Knowledge:
    """The instants at which one ego looked while one pedestrian was near, and whether it was told of them."""

    time: FloatArray
    """Times of these instants, ascending [s]."""
    told: BoolArray
    longest_gap: float
    """Instants further apart than this do not count as consecutive [s]."""

    def since(self, instant: float) -> float:
        """Return since when the ego had been told without interruption; nan if it was not told then [s].

        >>> times, told = np.array([0.0, 0.1, 0.2, 0.3]), np.array([True, False, True, True])
        >>> Knowledge(times, told, 0.15).since(0.35)
        0.2
        """
        last = int(np.searchsorted(self.time, instant + 1e-9)) - 1
        if last < 0 or not self.told[last] or instant - self.time[last] > self.longest_gap:
            return float("nan")
        apart = np.diff(self.time[: last + 1]) > self.longest_gap
        breaks = np.flatnonzero(~self.told[:last] | apart)
        return float(self.time[breaks[-1] + 1 if len(breaks) else 0])


NOTHING = Knowledge(np.zeros(0), np.zeros(0, dtype=np.bool_), 0.0)
"""Knowledge of a pedestrian who was never near when the ego looked."""


def knowledge_of(run: RecordedRun) -> Mapping[tuple[str, str], Knowledge] | None:
    """Return what each ego knew of each pedestrian near it, by names; ``None`` where it knew the truth."""
    rows = run.sensing
    if rows is None:
        return None
    gap = _LONGEST_GAP_STEPS * max(run.step_s, _PLAN_INTERVAL_S)
    egos, persons = rows.texts["ego_id"], rows.texts["object_id"]
    order = np.lexsort((np.arange(len(rows)), persons.codes, egos.codes))
    pair = np.column_stack([egos.codes, persons.codes])[order]
    begins = np.flatnonzero(np.any(np.diff(pair, axis=0, prepend=-2) != 0, axis=1))
    found: dict[tuple[str, str], Knowledge] = {}
    for index in np.split(order, begins[1:]) if len(order) else ():
        names = egos.at(int(index[0])), persons.at(int(index[0]))
        found[names] = Knowledge(rows.numbers["time_s"][index], rows.flags["told"][index], gap)
    return found
