"""Scripted pedestrians: their walks are computed here, not by SUMO, from the time and what they see."""
