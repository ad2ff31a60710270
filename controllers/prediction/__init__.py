"""How pedestrians and vehicles are expected to move."""
