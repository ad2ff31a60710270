"""The velocity-obstacle paper: scenes, rides, independent solver, claims and figures."""
