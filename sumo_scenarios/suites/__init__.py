"""Pedestrian test protocols: their parameter tables, and the scenarios built from them."""
