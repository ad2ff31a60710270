"""Ranks the crossings of a network: the runs, and the ranking made from them."""
