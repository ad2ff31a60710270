"""Study of the benefit of a roadside unit where a bus hides pedestrians: ``make study-roadside``."""
