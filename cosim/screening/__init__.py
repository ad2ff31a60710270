"""Ranking the crossings of a network: the runs, and what is made of them."""
