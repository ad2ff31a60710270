"""The drivable-area paper: its scenes, rides, claims and figures."""
