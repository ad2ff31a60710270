"""Scenarios: plain SUMO sources and their parameters."""
