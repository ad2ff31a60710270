"""SUMO's treatment of an external ego, as cases that can fail."""
