"""Whether and where the ego would come too near to a pedestrian if it only followed road and traffic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray, IntArray
from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch
from controllers.conflicts.path_conflicts import Conflicts, find
from controllers.drivable_area.clearances import Boxes, Shape
from controllers.geometry.footprints import footprints
from controllers.interface import Perception
from controllers.prediction.social_force_model import Walkers

SHIFTING = 1.3
"""Lateral speed at which the ego returns to its lane or changes lanes [m/s]."""
ROAD_MARGIN = 0.5
"""People up to this far from the road matter if they are about to enter it [m]."""
VIEW = 80.0
"""Vehicles further away do not matter [m]."""
LASTS = 2.0
"""Vehicles are expected to keep their acceleration and to move across the road for this long [s]."""


@dataclass(frozen=True, slots=True)
class Conflict:
    """The first meeting of a motion with a pedestrian."""

    name: str
    time: float
    """Time from now until the meeting [s]."""
    along: float
    """Place of the pedestrian at that time [m]."""
    across: float
    place: float
    """Place where the front bumper would have to stop for everybody in conflict [m]."""


def relevant(
    perception: Perception, watch: Watch, horizon: float, assume: PedestrianAssumptions
) -> Conflicts:
    """Return the pedestrians who are or will soon be on the road, and how they are expected to walk.

    Parameters
    ----------
    perception : what the ego knows
    watch : what the ego remembers of pedestrians; updated here
    horizon : time within which people who will be on the road count [s]
    assume : assumptions about people whose velocity does not say what they will do
    """
    road = perception.road
    band = road.right_edge - ROAD_MARGIN, road.left_edge + ROAD_MARGIN
    return find(perception, watch, band, 0.0, horizon, assume)


def walkers(people: Conflicts) -> Walkers:
    """Return the people as walkers who keep their expected velocities."""
    return Walkers(people.along, people.across, people.along_speed, people.across_speed)


@dataclass(frozen=True, slots=True)
class Outlook:
    """How the ego would drive without pedestrians, at K instants."""

    times: FloatArray
    along: FloatArray
    across: FloatArray
    heading: FloatArray
    speed: FloatArray


def outlook(perception: Perception, times: FloatArray, acceleration: FloatArray, target: float) -> Outlook:
    """Return how the ego would drive if it followed the road.

    Parameters
    ----------
    perception : what the ego knows
    times : instants from 0 [s]
    acceleration : acceleration from each instant to the next [m/s^2]
    target : across coordinate of the lane to be in [m]
    """
    ego = perception.ego
    steps = np.diff(times)
    changed = np.concatenate(([0.0], np.cumsum(acceleration[:-1] * steps)))
    # Where the sum falls below zero, the car stands until it speeds up again.
    speed = ego.speed + changed
    speed = speed - np.minimum(np.minimum.accumulate(speed), 0.0)
    along = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * steps)))
    shift = target - ego.across
    moved = np.minimum(SHIFTING * times, np.minimum(abs(shift), 0.5 * along))
    across = ego.across + np.sign(shift) * moved
    return Outlook(times, along, across, np.zeros(len(times)), speed)


def first_conflict(
    expected: Outlook, people: Conflicts, shape: Shape, margin: FloatArray, standoff: float
) -> Conflict | None:
    """Return the first pedestrian to whom the ego would not keep the margin; ``None`` if there is none.

    Parameters
    ----------
    expected : motion of the ego
    people : the pedestrians expected on the road
    shape : shape of the car
    margin : margin for each pedestrian, shape (n,) [m]
    standoff : distance kept to a pedestrian's path if no stop line asks for more [m]
    """
    if len(people) == 0:
        return None
    x = people.along[:, None] + people.along_speed[:, None] * expected.times
    y = people.across[:, None] + people.across_speed[:, None] * expected.times
    clearance = shape.clearance(expected.along, expected.across, expected.heading, x, y)
    met = (clearance < margin[:, None]) & (expected.speed > 0.1)
    whom = np.flatnonzero(met.any(axis=1))
    if len(whom) == 0:
        return None
    when = met[whom].argmax(axis=1)
    first = int(np.argmin(when))
    person, k = int(whom[first]), int(when[first])
    places = stopping_place(people, whom, x[whom, when], shape, standoff)
    return Conflict(
        people.names[person],
        float(expected.times[k]),
        float(x[person, k]),
        float(y[person, k]),
        float(places.min()),
    )


def stopping_place(
    people: Conflicts, whom: IntArray, met: FloatArray, shape: Shape, standoff: float
) -> FloatArray:
    """Return where the front bumper would have to stop for each of some people, shape (m,) [m].

    Parameters
    ----------
    people, whom : all people, and the indices of those to stop for
    met : where the latter are when the ego meets them [m]
    shape, standoff : as in :func:`first_conflict`
    """
    lines = people.stop_line[whom]
    beside = np.minimum(met, people.along[whom]) - shape.pedestrian_radius - standoff
    ahead = np.isfinite(lines) & (lines > shape.body.front)
    return np.asarray(np.where(ahead, np.minimum(lines, beside), beside))


def boxes(perception: Perception, times: FloatArray) -> Boxes:
    """Return other vehicles as rectangles at several times.

    Vehicles that drive in the same or the opposite direction go on along the road and, for a while, across
    it. Those in the same direction keep their acceleration for a while. Crossing vehicles stay where they
    are, because the right-of-way rules deal with what they will do. Vehicles behind the ego in its own path
    are left out: they follow.
    """
    vehicles, body = perception.vehicles, perception.ego.body
    box = footprints(vehicles)
    half = 0.5 * body.width
    across = perception.ego.across
    in_way = (box.right < across + half) & (box.left > across - half)
    behind = in_way & (0.5 * (box.rear + box.front) < 0.5 * body.length - body.rear_overhang)
    chosen = np.flatnonzero(~behind & (box.front > -VIEW) & (box.rear < VIEW))
    turned = vehicles.heading_error[chosen]
    crossing = np.abs(np.cos(turned)) < 0.5
    speed = np.where(crossing, 0.0, vehicles.along_speed[chosen])
    change = np.where(crossing, 0.0, np.clip(vehicles.acceleration[chosen], -6.0, 1.5))
    change = np.where(box.same_way[chosen], change, 0.0)
    stops = np.where(change < 0.0, np.maximum(speed, 0.0) / np.maximum(-change, 1e-9), np.inf)
    lasting = np.minimum(times, np.minimum(stops, LASTS)[:, None])
    gone = speed[:, None] * times + change[:, None] * lasting * (times - 0.5 * lasting)
    drift = np.where(crossing, 0.0, vehicles.across_speed[chosen])[:, None] * np.minimum(times, LASTS)
    middle = vehicles.along[chosen] - 0.5 * vehicles.length[chosen] * np.cos(turned)
    return Boxes(
        middle[:, None] + gone,
        vehicles.across[chosen][:, None] + drift,
        turned,
        0.5 * vehicles.length[chosen],
        0.5 * vehicles.width[chosen],
    )
