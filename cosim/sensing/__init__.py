"""Sensing of pedestrians: models between the world's truth and the controllers' perception."""
