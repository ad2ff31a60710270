"""Compares simulations with real tracks: rebuilt demand, runs over seeds, comparison and calibration."""
