"""The drivable-area method: what a car can reach, which ways it has past a pedestrian, and what each costs."""
