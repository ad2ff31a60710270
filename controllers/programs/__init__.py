"""Quadratic programs of a fixed layout, and what solves them."""
