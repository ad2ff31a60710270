"""Quadratic programs: the problem, its solution with a certificate, and the solvers that qpsolvers knows."""
