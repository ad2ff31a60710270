"""What SUMO does to an external ego, as cases that can fail."""
