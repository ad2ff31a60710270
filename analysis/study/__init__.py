"""Reads, summarises, compares and writes many runs."""
