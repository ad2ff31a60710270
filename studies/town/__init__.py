"""Study that screens a whole town: ``make study-town``."""
