"""The potential-field paper: its scenes, spread of directions, claims and figures."""
