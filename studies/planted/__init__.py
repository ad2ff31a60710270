"""Does a screening find the one dangerous crossing of a town? ``make study-planted``."""
