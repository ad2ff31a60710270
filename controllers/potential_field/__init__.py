"""The potential-field method: steering down a field made by pedestrians, vehicles and lanes."""
