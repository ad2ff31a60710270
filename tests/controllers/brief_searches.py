"""Settings with which a controller that searches does so in less time.

For tests of promises that do not depend on how long it searches; with its own settings it is asked in all
situations of the contract, and drives in SUMO.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

BRIEF_SEARCHES: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {"vo_ga": {"generations": 10}, "drivable_area": {"generations": 3}}
)
"""By the controller's name."""
