"""Recorded trajectories of real road users: readers of several layouts, and one table for all."""
