"""Simulation held against real tracks: the demand rebuilt, runs over seeds, comparison, calibration."""
