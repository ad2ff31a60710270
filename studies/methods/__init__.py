"""The methods of the papers against each other in traffic: ``make study-papers``."""
