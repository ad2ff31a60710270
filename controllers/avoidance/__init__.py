"""The velocity-obstacle paper's own optimisation problem, and its solvers."""
