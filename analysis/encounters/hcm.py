"""Level of service of pedestrians by their mean delay, as the Highway Capacity Manual grades it."""

from __future__ import annotations

import math

LEVELS = ((5.0, "A"), (10.0, "B"), (20.0, "C"), (30.0, "D"), (45.0, "E"), (math.inf, "F"))
"""Mean delay below which a level of service holds [s], HCM 2000 and 2010."""


def level_of_service(delay: float) -> str:
    """Return the level of service of a mean delay [s].

    >>> level_of_service(13.9)
    'C'
    """
    return next(level for limit, level in LEVELS if delay < limit)
