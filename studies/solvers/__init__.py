"""What the choice of a solver changes in closed loop: ``make study-solvers``."""
