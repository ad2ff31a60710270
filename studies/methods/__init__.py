"""Compares the methods of the papers in traffic: ``make study-papers``."""
