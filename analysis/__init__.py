"""Encounters, metrics and reports from recorded runs; it only reads files."""
