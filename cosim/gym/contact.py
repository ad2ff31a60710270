"""How near an ego came to other road users within a step, and whether it touched one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.geometry import clearance, rectangle_separation, to_frame
from cosim.arrays import FloatArray
from cosim.step.world import EgoTruth, PersonsTruth, Snapshot

PARTS = 4
"""Number of instants checked per step; road users move in straight lines between two samples."""
NEAR = 20.0
"""Road users farther from the ego's front bumper than this, in x or y, are ignored [m]."""


@dataclass(frozen=True, slots=True)
class Nearness:
    """How near one ego came to others in one step."""

    pedestrian: float
    """Smallest distance from the ego's body to a pedestrian's disc [m]; inf if nobody is within `NEAR`."""
    vehicle: bool
    """Whether the ego overlaps another vehicle."""

    @property
    def touches_pedestrian(self) -> bool:
        """Whether the ego's body touches a pedestrian's disc."""
        return self.pedestrian <= 0.0


def nearness(before: EgoTruth, now: EgoTruth, last: Snapshot, snapshot: Snapshot) -> Nearness:
    """Return how near an ego was to others between two samples.

    Parameters
    ----------
    before, now
        The ego at the beginning and at the end.
    last, snapshot
        Everybody at both instants; pedestrians who are only in the second snapshot count as standing still.
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
    """Return the rows of road users near an ego."""
    return np.flatnonzero((np.abs(x - ego.x) < NEAR) & (np.abs(y - ego.y) < NEAR))


def _between(
    last: PersonsTruth, people: PersonsTruth, near: NDArray[np.intp], shares: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return x and y of the near pedestrians at shares of the step, each of shape (shares, people)."""
    places = {name: place for place, name in enumerate(last.names)}
    rows = [places.get(people.names[i], -1) for i in near]
    x = np.array([last.x[row] if row >= 0 else people.x[i] for i, row in zip(near, rows, strict=True)])
    y = np.array([last.y[row] if row >= 0 else people.y[i] for i, row in zip(near, rows, strict=True)])
    return x + shares * (people.x[near] - x), y + shares * (people.y[near] - y)


def _overlaps(ego: EgoTruth, snapshot: Snapshot) -> bool:
    """Return whether an ego overlaps another vehicle, be it an ego or not."""
    cars, egos = snapshot.vehicles, [one for one in snapshot.egos if one.name != ego.name]
    own = np.array([(one.x, one.y, one.heading, one.body.length, one.body.width) for one in egos])
    theirs = np.column_stack((cars.x, cars.y, cars.heading, cars.length, cars.width))
    all_x, all_y, all_headings, all_lengths, widths = np.vstack((theirs, own.reshape(-1, 5))).T
    near = _near(ego, all_x, all_y)
    if not len(near):
        return False
    half, lengths, headings = 0.5 * ego.body.length, all_lengths[near], all_headings[near]
    gap, _ = rectangle_separation(
        np.full(len(near), ego.x - half * np.cos(ego.heading)),
        np.full(len(near), ego.y - half * np.sin(ego.heading)),
        np.full(len(near), ego.heading),
        ego.body.length,
        ego.body.width,
        all_x[near] - 0.5 * lengths * np.cos(headings),
        all_y[near] - 0.5 * lengths * np.sin(headings),
        headings,
        lengths,
        widths[near],
    )
    return bool((gap < 0.0).any())
