"""A whole town screened: ``make study-town``."""
