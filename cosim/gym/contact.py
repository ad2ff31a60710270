"""How near an ego has come to others within a step, and whether it touched anybody."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.geometry import clearance, rectangle_separation, to_frame
from cosim.arrays import FloatArray
from cosim.step.world import EgoTruth, PersonsTruth, Snapshot

PARTS = 4
"""Instants looked at between two samples; straight lines connect them."""
NEAR = 20.0
"""Others further from the front bumper are not looked at [m]."""


@dataclass(frozen=True, slots=True)
class Nearness:
    """Of one ego in one step."""

    pedestrian: float
    """Smallest distance between the body and a pedestrian's disc [m]; inf with nobody within `NEAR`."""
    vehicle: bool
    """Whether it overlaps another vehicle."""

    @property
    def touches_pedestrian(self) -> bool:
        """Whether body and disc touch."""
        return self.pedestrian <= 0.0


def nearness(before: EgoTruth, now: EgoTruth, last: Snapshot, snapshot: Snapshot) -> Nearness:
    """Return how near an ego was to others between two samples.

    Parameters
    ----------
    before, now
        The ego at the beginning and at the end.
    last, snapshot
        Everybody at both instants; who is in the second one alone has not moved.
    """
    people = snapshot.persons
    near = _near(now, people.x, people.y)
    nearest = np.inf
    if len(near):
        shares = np.linspace(0.0, 1.0, PARTS + 1)[1:, None]
        half = 0.5 * now.body.length
        turn = np.arctan2(np.sin(now.heading - before.heading), np.cos(now.heading - before.heading))
        heading = before.heading + shares * turn
        x = before.x + shares * (now.x - before.x) - half * np.cos(heading)
        y = before.y + shares * (now.y - before.y) - half * np.sin(heading)
        px, py = _between(last.persons, people, near, shares)
        ahead, left = to_frame(px - x, py - y, heading)
        nearest = float(clearance(ahead, left, half, 0.5 * now.body.width, people.radius[near]).min())
    return Nearness(nearest, _overlaps(now, snapshot))


def _near(ego: EgoTruth, x: FloatArray, y: FloatArray) -> NDArray[np.intp]:
    """Return the rows of those near an ego."""
    return np.flatnonzero((np.abs(x - ego.x) < NEAR) & (np.abs(y - ego.y) < NEAR))


def _between(
    last: PersonsTruth, people: PersonsTruth, near: NDArray[np.intp], shares: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return where those near were at shares of the step, shape (shares, people)."""
    places = {name: place for place, name in enumerate(last.names)}
    rows = [places.get(people.names[i], -1) for i in near]
    x = np.array([last.x[row] if row >= 0 else people.x[i] for i, row in zip(near, rows, strict=True)])
    y = np.array([last.y[row] if row >= 0 else people.y[i] for i, row in zip(near, rows, strict=True)])
    return x + shares * (people.x[near] - x), y + shares * (people.y[near] - y)


def _overlaps(ego: EgoTruth, snapshot: Snapshot) -> bool:
    cars = snapshot.vehicles
    near = _near(ego, cars.x, cars.y)
    if not len(near):
        return False
    half, lengths, headings = 0.5 * ego.body.length, cars.length[near], cars.heading[near]
    gap, _ = rectangle_separation(
        np.full(len(near), ego.x - half * np.cos(ego.heading)),
        np.full(len(near), ego.y - half * np.sin(ego.heading)),
        np.full(len(near), ego.heading),
        ego.body.length,
        ego.body.width,
        cars.x[near] - 0.5 * lengths * np.cos(headings),
        cars.y[near] - 0.5 * lengths * np.sin(headings),
        headings,
        lengths,
        cars.width[near],
    )
    return bool((gap < 0.0).any())
