"""What a roadside unit buys where a bus hides pedestrians: ``make study-roadside``."""
