"""``make zoo``: controllers on networks that nobody tuned for, made and collected from a number of seed."""
