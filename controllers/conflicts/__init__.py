"""Pedestrians in conflict with the ego's way: in it, beside it, or hidden from view."""
