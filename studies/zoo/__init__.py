"""``make zoo``: controllers on networks that nobody tuned for, generated from a seed or collected."""
