"""Study of whether the simulation of the Braunschweig junction is like the real street."""
