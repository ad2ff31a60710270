"""Intervals, paired tests and numbers of replications: pure functions of arrays and numbers."""
