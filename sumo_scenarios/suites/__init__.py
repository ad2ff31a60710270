"""Pedestrian test protocols: parameter tables, and what makes scenarios of them."""
