"""Pedestrians that no simulator has: where they walk is computed here, from the time and what they see."""
