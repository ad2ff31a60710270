"""Which pedestrians walk on a crossing or wait for it, derived from their positions alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import shapely
from numpy.typing import NDArray
from shapely import STRtree

from analysis.stretches import stretches
from controllers.interface import PedestrianPhase
from cosim.arrays import FloatArray, IntArray
from cosim.sumo.network import Network

BESIDE_M = 0.5
"""Crossings are widened by this to either side, because people walk beside the markings [m]."""
AHEAD_M = 4.0
"""Pedestrians at most this far from the next crossing that they walk on count as waiting for it [m]."""
AHEAD_S = 60.0
KERB_M, STANDING_MPS = 3.0, 0.3
"""This near to where they came onto a crossing [m], pedestrians slower than this [m/s] still wait, because
kerbs are drawn roughly."""
SHORTEST_S = 0.5
"""A shorter stay on a crossing only touches its edge and does not count as a walk over it [s]."""


@dataclass(frozen=True, slots=True)
class Phases:
    """Phases of n samples of pedestrians; lists of length n."""

    phase: list[str]
    crossing: list[str | None]
    """Crossing that the pedestrian walks on or waits for; ``None`` for none."""


class CrossingPhases:
    """Finds the phases of pedestrians at the crossings of a network.

    Parameters
    ----------
    network
    """

    def __init__(self, network: Network) -> None:
        self._names = tuple(network.crossings)
        strips = [
            shapely.LineString(one.axis).buffer(0.5 * one.width + BESIDE_M, cap_style="flat")
            for one in network.crossings.values()
        ]
        self._strips = np.array(strips, dtype=object)
        self._axes = np.array(
            [shapely.LineString(one.axis) for one in network.crossings.values()], dtype=object
        )
        self._tree = STRtree(strips)

    def of(self, people: pd.DataFrame, step_s: float) -> Phases:
        """Return the phases of samples that are sorted by id and time.

        A pedestrian waits if they are near a crossing and walk onto it within 60 s, as the rest of the track
        shows.
        """
        count = len(people)
        phase = [PedestrianPhase.WALKING.value] * count
        crossing: list[str | None] = [None] * count
        if not self._names or not count:
            return Phases(phase, crossing)
        points: Any = shapely.points(people["x_m"].to_numpy(), people["y_m"].to_numpy())
        on = self._on(points)
        codes = pd.factorize(people["id"])[0]
        speed = people["speed_mps"].to_numpy()
        for own in np.split(np.arange(count), np.flatnonzero(np.diff(codes)) + 1):
            walks = self._walks(on[own], step_s)
            begin = 0
            for begin_of_walk, last, number in walks:
                first = begin_of_walk + self._stood(
                    points[own[begin_of_walk : last + 1]], speed[own], begin_of_walk
                )
                for at in own[first : last + 1]:
                    phase[at], crossing[at] = PedestrianPhase.CROSSING.value, self._names[number]
                before = own[max(begin, first - int(AHEAD_S / step_s)) : first]
                near = shapely.distance(points[before], self._strips[number]) <= AHEAD_M
                for at in before[_last_stretch(near)]:
                    phase[at], crossing[at] = PedestrianPhase.WAITING.value, self._names[number]
                begin = last + 1
        return Phases(phase, crossing)

    def _stood(self, walk: NDArray[np.object_], speed: FloatArray, first: int) -> int:
        """Return for how many samples at the beginning of a walk the pedestrian still stands at the kerb."""
        at_kerb = shapely.distance(walk, walk[0]) <= KERB_M
        left = int(np.argmin(at_kerb)) if not at_kerb.all() else len(walk)
        stands = np.flatnonzero(speed[first : first + left] < STANDING_MPS)
        return int(stands[-1]) + 1 if len(stands) and stands[-1] + 1 < len(walk) else 0

    def _on(self, points: NDArray[np.object_]) -> IntArray:
        """Return the crossing that each point is on, −1 for none; of several, that with the nearest axis."""
        point, strip = self._tree.query(points, predicate="within")
        found = np.full(len(points), -1, dtype=np.int64)
        away = shapely.distance(points[point], self._axes[strip])
        for at in np.argsort(-away, kind="stable"):
            found[point[at]] = strip[at]
        return found

    def _walks(self, on: IntArray, step_s: float) -> list[tuple[int, int, int]]:
        """Return the first and last sample of each walk over a crossing, and the crossing's number."""
        walks = []
        for number in np.unique(on[on >= 0]).tolist():
            for first, last in stretches(on == number):
                if (last - first) * step_s >= SHORTEST_S:
                    walks.append((first, last, number))
        return sorted(walks)


def _last_stretch(near: NDArray[np.bool_]) -> slice:
    """Return the unbroken stretch of near samples at the end."""
    away = np.flatnonzero(~near)
    return slice(int(away[-1]) + 1 if len(away) else 0, len(near))
