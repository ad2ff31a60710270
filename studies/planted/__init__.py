"""Study of whether a screening finds the one dangerous crossing of a town: ``make study-planted``."""
