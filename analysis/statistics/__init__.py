"""Intervals, paired tests and numbers of replications: pure functions, every one of arrays alone."""
