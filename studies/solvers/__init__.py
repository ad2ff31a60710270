"""Study of how the choice of a solver affects the closed loop: ``make study-solvers``."""
