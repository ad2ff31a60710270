"""The drivable-area paper: scenes, rides, claims and figures."""
