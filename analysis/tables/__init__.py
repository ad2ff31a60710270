"""Columns and tables: each is declared once and gives the texts of CSV files and data dictionaries."""
