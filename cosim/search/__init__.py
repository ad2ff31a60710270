"""Searches a scenario for failures of a controller, and estimates how often they would happen."""
