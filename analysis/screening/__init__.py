"""Finds the dangerous crossings of a network, from runs that record everybody."""
