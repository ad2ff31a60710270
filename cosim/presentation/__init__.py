"""Presentation of finished runs: numbers, comparisons, reports and pictures."""
