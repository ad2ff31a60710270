"""Encounters of egos and pedestrians: the data that metrics are computed from."""
