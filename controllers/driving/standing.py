"""What counts as standing, and how a car is kept there."""

STANDING = 0.05
"""A slower car stands, if its speed is known as well as the ego's is [m/s]."""
VEHICLE_STANDING = 0.1
"""Another vehicle that is slower stands [m/s]."""
HOLDING = -2.0
"""Keeps a standing car standing [m/s^2]."""
HOLDING_GENTLY = -0.5
"""Keeps a car standing whose plan is smooth and ends in a standstill [m/s^2]."""
