"""The drivable-area method: what a car can reach, its ways past a pedestrian, and what each costs."""
