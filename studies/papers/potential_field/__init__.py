"""The potential-field paper: scenes, spread of directions, claims and figures."""
