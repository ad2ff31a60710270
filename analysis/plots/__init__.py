"""Figures of a recorded run."""
