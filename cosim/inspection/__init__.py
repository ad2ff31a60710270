"""Inspection of a SUMO network and its demand for a study of crossings; runs no simulation."""
