"""One file per metric: UNIT, WORSE, SOURCE, its columns, ``compute`` and, for encounters, ``summarise``."""
