"""Recordings of runs: their columns and their reader."""
