"""Criteria of a check: reading and evaluation."""
