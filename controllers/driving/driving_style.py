"""How briskly a driver drives when there are no pedestrians."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DrivingStyle:
    """Parameters of the car-following model and the speed profile."""

    headway: float = 1.0
    """Time gap to a leader [s]."""
    standstill_gap: float = 2.5
    """Gap to a standing leader [m]."""
    acceleration: float = 1.8
    """Acceleration from standstill on a free road [m/s^2]."""
    deceleration: float = 2.0
    """Comfortable deceleration [m/s^2]."""
    lateral_acceleration: float = 3.7
    """Lateral acceleration in bends: a side friction of 0.38, for which low-speed streets are designed at
    16 km/h [AASHTO2018]_ [m/s^2]."""
    slowest_bend: float = 2.0
    """Lowest speed in a bend, however sharp a coarse lane shape makes it seem [m/s]."""
    stop_gap: float = 0.5
    """Distance kept to a stop line [m]."""
    stop_headway: float = 0.5
    """Time gap to a stop line [s]."""
    side_clearance: float = 0.3
    """Distance at which a standing vehicle is driven past [m]."""
    passing_speed: float = 4.0
    """Speed past a standing vehicle that juts out [m/s]."""
    swing_angle: float = 0.55
    """Largest heading error when the ego swings out past a standing vehicle [rad]."""
    swing_curvature: float = 0.22
    """Curvature with which it swings out [1/m]."""
    swing_acceleration: float = 2.0
    """Lateral acceleration that limits the curvature of swinging out at higher speed [m/s^2]."""
    room_to_swing: float = 7.0
    """Gap kept to a standing vehicle during a lane change that cannot yet swing out past it [m]."""
    room_to_change: float = 10.0
    """Distance kept to what the ego wants to leave its lane for, so that it has room to steer out [m]."""
