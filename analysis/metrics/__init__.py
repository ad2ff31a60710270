"""One file per metric, each with UNIT, WORSE, SOURCE and ``compute``."""
