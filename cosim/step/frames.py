"""Conversion between SUMO's way of giving the pose of a vehicle and ours.

SUMO: angle in degrees clockwise from north, position of the front bumper's centre. Here: heading in
radians counter-clockwise from east, position of the rear axle's centre.
"""

from __future__ import annotations

import math


def wrapped(angle: float) -> float:
    """Return an angle of the same direction within (−pi, pi] [rad].

    >>> round(wrapped(3 * math.pi / 2), 6) == round(-math.pi / 2, 6)
    True
    """
    turned = math.remainder(angle, 2.0 * math.pi)
    return math.pi if turned == -math.pi else turned


def heading_of(degrees: float) -> float:
    """Return the heading in (−pi, pi] [rad] of a SUMO angle [degrees].

    >>> heading_of(90.0)
    0.0
    """
    return wrapped(math.radians(90.0 - degrees))


def degrees_of(heading: float) -> float:
    """Return the SUMO angle in [0, 360) [degrees] of a heading [rad].

    >>> degrees_of(0.0)
    90.0
    """
    return (90.0 - math.degrees(heading)) % 360.0


def front_of(x: float, y: float, heading: float, front: float) -> tuple[float, float]:
    """Return the front bumper's centre [m] from the rear axle's.

    Parameters
    ----------
    x, y : rear axle [m]
    heading : heading of the vehicle [rad]
    front : distance from the rear axle to the front bumper, ``Body.front`` [m]

    >>> front_of(1.0, 2.0, 0.0, 3.5)
    (4.5, 2.0)
    """
    return x + front * math.cos(heading), y + front * math.sin(heading)


def rear_axle_of(front_x: float, front_y: float, heading: float, front: float) -> tuple[float, float]:
    """Return the rear axle's centre [m] from the front bumper's; the inverse of `front_of`.

    >>> rear_axle_of(4.5, 2.0, 0.0, 3.5)
    (1.0, 2.0)
    """
    return front_x - front * math.cos(heading), front_y - front * math.sin(heading)
