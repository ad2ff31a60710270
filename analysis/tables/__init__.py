"""Columns and tables: each declared once, and the texts of CSV files and data dictionaries made from it."""
