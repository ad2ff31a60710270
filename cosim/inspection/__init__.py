"""Inspects a SUMO network and its demand for a study of crossings, without running a simulation."""
