"""The velocity-obstacle paper: its scenes, rides, independent solver, claims and figures."""
