"""Encounters, metrics and reports from recorded runs; reads files only."""
