"""What becomes of everybody on a road when a share of its cars are egos: ``make study-penetration``."""
