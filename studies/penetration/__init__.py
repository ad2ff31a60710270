"""Study of all road users when a share of the cars are egos: ``make study-penetration``."""
