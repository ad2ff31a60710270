"""Searching a scenario for what a controller fails at, and how often that would happen."""
