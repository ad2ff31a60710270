"""Where a pedestrian could step out from behind a standing vehicle, and how fast the ego may drive there.

The line of sight from the ego's sensor past the corner of a standing vehicle bounds what the ego sees. Behind
that line there may be pedestrians of whom it has not been told. Those nearest to its path stand right ahead
of the vehicle's far end: that is the vehicle's *hidden place*. By the rule of assured clear distance, the ego
must be able at every instant to stop before their path, or have its front past it before they can be there.

Not considered: moving vehicles (they will soon be where they now hide somebody), buildings, places beyond the
sensor's range, and pedestrians who walk into the ego's side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.geometry.box_clearances import corners
from controllers.geometry.footprints import footprints
from controllers.geometry.plane import to_plane
from controllers.interface import Perception

RADIUS = 0.25
"""Radius of a hidden pedestrian [m]."""
STANDING = 2.0
"""Vehicles below this speed stand, or are about to stand where somebody may walk behind them [m/s]."""
LOOK_AHEAD = 80.0
"""Along coordinate up to which the speed is limited [m]."""
SPACING = 0.5
"""Distance between the places for which the limit is computed [m]."""
UNBOUNDED = 100.0
"""This speed stands for no limit [m/s]."""
AT_ONCE = 1e4
"""Deceleration that counts as stopping at once; greater and infinite values are cut to it [m/s^2]."""


@dataclass(frozen=True, slots=True)
class HiddenPedestrian:
    """Assumptions about pedestrians who cannot be seen, and how the ego reacts to them."""

    speed: float
    """Speed at which they step out; 0: no hidden pedestrians are assumed [m/s]."""
    reaction: float = 0.8
    """Time from the first appearance of any part of a pedestrian to full braking, with no braking assumed
    before: the delay until the ego is told of them (0.2 to 0.3 s with ``onboard``), one plan, half of the
    ramp that the jerk limit leaves, and the brake's lag [s]."""
    braking: float = 7.0
    """Full deceleration of the ego [m/s^2]."""
    creep: float = 2.0
    """The ego need not drive slower than this, however near a pedestrian may be hidden [m/s]."""


@dataclass(frozen=True, slots=True)
class Shadows:
    """Standing vehicles beside the path; n of them, in a plane with the route frame's origin and axes."""

    corners: FloatArray
    """(n, 4, 2) corners of each vehicle [m]."""
    side: FloatArray
    """(n,) −1 for vehicles on the right of the path, 1 on the left."""
    along: FloatArray
    """(n,) along coordinate of the centre of a pedestrian who comes out just ahead of its far end [m]."""
    foot: FloatArray
    """(n, 2) point where that pedestrian's path meets the centre line [m]."""
    outward: FloatArray
    """(n, 2) unit vector from there towards the vehicle's side."""
    edge: FloatArray
    """(n,) distance from the centre line to the edge of the path on that side [m]."""

    def __len__(self) -> int:
        return len(self.along)

    def distances(self, eyes: FloatArray) -> FloatArray:
        """Return how far outward the nearest wholly hidden disc is, for sensor positions (q, 2): (q, n) [m].

        The line of sight past the corner that appears nearest to the path is the border of what is seen. A
        disc whose centre is one radius behind that line cannot be seen. The distance is inf where the line
        does not cross the way of a pedestrian who comes out.
        """
        rays = self.corners[None] - eyes[:, None, None, :]
        # Angles from the direction of the ego's path where the pedestrian's meets it, clockwise positive. No
        # corner of a vehicle is straight behind the sensor, so they do not wrap.
        forward = self.side[:, None] * np.column_stack((self.outward[:, 1], -self.outward[:, 0]))
        turned = np.arctan2(
            rays[..., 0] * forward[:, None, 1] - rays[..., 1] * forward[:, None, 0],
            (rays * forward[:, None, :]).sum(axis=-1),
        )
        nearest = np.argmin(-self.side[None, :, None] * turned, axis=2)
        ray = np.take_along_axis(rays, nearest[:, :, None, None], axis=2)[:, :, 0, :]
        ray = ray / np.maximum(np.hypot(ray[..., 0], ray[..., 1]), 1e-9)[..., None]
        into = self.side[None, :, None] * np.stack((-ray[..., 1], ray[..., 0]), axis=-1)
        corner = np.take_along_axis(
            np.broadcast_to(self.corners, (len(eyes), *self.corners.shape)), nearest[:, :, None, None], axis=2
        )[:, :, 0, :]
        slope = (self.outward[None] * into).sum(axis=-1)
        behind = ((self.foot[None] - corner) * into).sum(axis=-1)
        safe = np.where(slope > 1e-6, slope, 1.0)
        return np.where(slope > 1e-6, (RADIUS - behind) / safe, np.inf)


def assured_speed(gap: FloatArray, time: FloatArray, assume: HiddenPedestrian) -> FloatArray:
    """Return the highest speed at which the front does not hit a pedestrian who steps out now [m/s].

    This is the larger of two speeds. At the speed ``v`` with ``v ρ + v² / (2 b) = gap`` the ego just stops in
    time. Up to ``v = 2 b (time − ρ)``, wherever it can no longer stop, it has passed before the pedestrian
    arrives. The result is never below ``creep``.

    Parameters
    ----------
    gap : from the front bumper to the pedestrian's path [m]
    time : time that the pedestrian needs to reach the ego's path [s]
    assume : ρ and b are its ``reaction`` and ``braking``

    Examples
    --------
    With 0.5 s and 7 m/s², 10 m/s need 12.1 m; at a place that a pedestrian reaches only after 1 s, 7 m/s are
    allowed.

    >>> rule = HiddenPedestrian(1.5, reaction=0.5)
    >>> assured_speed(np.array([12.142857, 1.0]), np.array([0.2, 1.0]), rule).round(3).tolist()
    [10.0, 7.0]
    """
    braking = min(assume.braking, AT_ONCE)
    lost = assume.reaction * braking
    stops = np.sqrt(lost**2 + 2.0 * braking * np.maximum(gap, 0.0)) - lost
    passes = 2.0 * braking * (time - assume.reaction)
    return np.maximum(np.maximum(stops, np.minimum(passes, UNBOUNDED)), assume.creep)


def speed_limit(
    perception: Perception, band: tuple[float, float], assume: HiddenPedestrian
) -> tuple[FloatArray, FloatArray] | None:
    """Return positions of the rear axle and the speed that hidden places allow there; ``None`` for no limit.

    Parameters
    ----------
    perception : what the ego is told
    band : right and left end of the band that the ego's body sweeps [m]
    assume : assumptions about a hidden pedestrian

    Notes
    -----
    Each position is judged from where the sensor will be then, with the vehicles at their present places. So
    the limit rises as the ego sees past a corner, and ends when its front has passed the hidden place.
    """
    if perception.eyesight is None or assume.speed <= 0.0:
        return None
    found = shadows(perception, band)
    if found is None:
        return None
    eyesight, body, ego = perception.eyesight, perception.ego.body, perception.ego
    places = np.arange(0.0, LOOK_AHEAD + 0.5 * SPACING, SPACING)
    across = (
        ego.across + eyesight.left * np.cos(ego.heading_error) + eyesight.ahead * np.sin(ego.heading_error)
    )
    eyes = to_plane(perception.road, places + eyesight.ahead, np.full(len(places), across))[0]
    outward = found.distances(eyes)
    gap = found.along[None] - RADIUS - body.front - places[:, None]
    hidden = np.isfinite(outward) & (gap > 0.0) & ~_watched(perception, found, outward)
    hidden &= ~_blocked(found, perception, outward)
    if not hidden.any():
        return None
    time = np.maximum(np.where(hidden, outward, np.inf) - RADIUS - found.edge, 0.0) / assume.speed
    allowed = np.where(hidden, assured_speed(gap, time, assume), UNBOUNDED).min(axis=1)
    return places, allowed


def reached(places: FloatArray, allowed: FloatArray, positions: FloatArray, braking: float) -> FloatArray:
    """Return the limit at positions, low enough to slow down for the limits ahead with ``braking``.

    ``v(p) = min over q ≥ p of sqrt(allowed(q)² + 2 braking (q − p))``

    Parameters
    ----------
    places, allowed : as :func:`speed_limit` returns them [m, m/s]
    positions : shape (N,) [m]
    braking : [m/s^2]

    >>> reached(np.array([0.0, 6.0]), np.array([9.0, 5.0]), np.array([0.0, 6.0]), 2.0).tolist()
    [7.0, 5.0]
    """
    ahead = places[None] - positions[:, None]
    squares = np.where(ahead > -SPACING, allowed**2 + 2.0 * braking * np.maximum(ahead, 0.0), UNBOUNDED**2)
    return np.asarray(np.sqrt(squares.min(axis=1)))


def shadows(perception: Perception, band: tuple[float, float]) -> Shadows | None:
    """Return the standing vehicles beside the path ahead of the sensor; ``None`` without any."""
    eyesight, them = perception.eyesight, perception.vehicles
    assert eyesight is not None, "asked for those who are told of everybody"
    slow = np.hypot(them.along_speed, them.across_speed) < STANDING
    if not slow.any():
        return None
    low, high, right, left = (values[slow] for values in footprints(them)[:4])
    beside = np.where(left <= band[0], -1.0, np.where(right >= band[1], 1.0, 0.0))
    kept = (beside != 0.0) & (high > eyesight.ahead) & (low < LOOK_AHEAD)
    if not kept.any():
        return None
    rows, side = np.flatnonzero(slow)[kept], beside[kept]
    along = high[kept] + RADIUS
    foot, heading = to_plane(perception.road, along, np.zeros(len(along)))
    outward = side[:, None] * np.column_stack((-np.sin(heading), np.cos(heading)))
    edge = np.where(side < 0.0, -band[0], band[1])
    return Shadows(_corners(perception, rows), side, along, foot, outward, edge)


def _corners(perception: Perception, rows: NDArray[np.int64]) -> FloatArray:
    """Return the corners of vehicles in the plane, (n, 4, 2) [m]."""
    them = perception.vehicles
    error, length, width = them.heading_error[rows], them.length[rows], them.width[rows]
    front_across = them.across[rows] + 0.5 * length * np.sin(error)
    front, heading = to_plane(perception.road, them.along[rows], front_across)
    return corners(front, heading + error, length, width)


def _watched(perception: Perception, found: Shadows, outward: FloatArray) -> NDArray[np.bool_]:
    """Return which hidden places are in areas that others watch for the ego, (q, n)."""
    eyesight, ego = perception.eyesight, perception.ego
    seen = np.zeros(outward.shape, dtype=np.bool_)
    if eyesight is None or not len(eyesight.watched):
        return seen
    course = ego.heading - ego.heading_error
    relative = eyesight.watched[:, :2] - [ego.x, ego.y]
    cosine, sine = np.cos(course), np.sin(course)
    watcher_x = relative[:, 0] * cosine + relative[:, 1] * sine
    watcher_y = relative[:, 1] * cosine - relative[:, 0] * sine + ego.across
    away = np.where(np.isfinite(outward), outward, 0.0)[..., None]
    place = found.foot[None] + away * found.outward[None]
    for x, y, radius in zip(watcher_x, watcher_y, eyesight.watched[:, 2], strict=True):
        seen |= np.hypot(place[..., 0] - x, place[..., 1] - y) < radius - RADIUS
    return seen


def _blocked(found: Shadows, perception: Perception, outward: FloatArray) -> NDArray[np.bool_]:
    """Return for which hidden places another standing vehicle leaves no room or blocks the way, (q, n)."""
    them = perception.vehicles
    slow = np.hypot(them.along_speed, them.across_speed) < STANDING
    low, high, right, left = (values[slow] for values in footprints(them)[:4])
    beside = (low[None] < found.along[:, None] + RADIUS) & (high[None] > found.along[:, None] - RADIUS + 1e-9)
    # Distances outward from the centre line, on the side of each hidden place, (n, m).
    near = np.where(found.side[:, None] < 0.0, -left[None], right[None])
    far = np.where(found.side[:, None] < 0.0, -right[None], left[None])
    between = beside & (far > found.edge[:, None])
    return np.asarray((between[None] & (near[None] < outward[..., None] + RADIUS)).any(axis=2))
