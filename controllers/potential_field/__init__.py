"""The potential-field method: steering down a field that pedestrians, vehicles and lanes make."""
