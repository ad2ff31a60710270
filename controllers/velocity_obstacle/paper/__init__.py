"""The velocity-obstacle paper's own optimisation problem, and its solvers (``vo_paper``, ``vo_ga``)."""
