"""Shapes on the road: the road laid out in a plane, and how near bodies come to each other on it."""
