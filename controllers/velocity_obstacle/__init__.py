"""The velocity-obstacle method: collision cones and decision rules, in two formulations."""
