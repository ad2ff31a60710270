"""Colours of the Euro NCAP rating of 2026 for crossing and walking pedestrians, and their points."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

COLOURS = ("green", "yellow", "orange", "brown", "red")
"""Colours from best to worst."""
FACTORS: Mapping[str, float] = MappingProxyType(
    {"green": 1.0, "yellow": 0.75, "orange": 0.5, "brown": 0.25, "red": 0.0}
)
"""Share of a case's points for each colour."""
_BANDS: tuple[tuple[float, tuple[tuple[str, float], ...]], ...] = (
    (20.0, ()),
    (30.0, (("brown", 10.0),)),
    (40.0, (("orange", 10.0), ("brown", 20.0))),
    (float("inf"), (("yellow", 10.0), ("orange", 20.0), ("brown", 30.0))),
)
"""Bands of test speed up to a limit, with the colours below each impact speed [km/h]."""


def colour(ego_speed_kmh: float, impact_speed_kmh: float | None, avoidance_only: bool = False) -> str:
    """Return the colour of a case.

    The colour is green without a contact. Otherwise it depends on test speed and relative impact speed
    [km/h]:

    ======== ========= ========== ========== =====
    test     yellow    orange     brown      red
    ======== ========= ========== ========== =====
    to 20                                    > 0
    to 30                         (0, 10)    >= 10
    to 40              (0, 10)    [10, 20)   >= 20
    above    (0, 10)   [10, 20)   [20, 30)   >= 30
    ======== ========= ========== ========== =====

    Parameters
    ----------
    ego_speed_kmh : test speed [km/h]
    impact_speed_kmh : relative impact speed; ``None`` without a contact [km/h]
    avoidance_only : whether every contact is red, as for turning egos

    Notes
    -----
    The table is that of [EuroNCAP2026]_, from a transcription, which gives test speeds in steps of 10 km/h. A
    speed between two steps gets the band of the higher one here. The tolerance of 2 km/h for verifying a
    manufacturer's own results is not applied.

    Examples
    --------
    >>> colour(40.0, None), colour(40.0, 9.9), colour(40.0, 10.0), colour(40.0, 20.0)
    ('green', 'orange', 'brown', 'red')
    """
    if impact_speed_kmh is None:
        return "green"
    if avoidance_only:
        return "red"
    bands = next(bands for highest, bands in _BANDS if ego_speed_kmh <= highest)
    return next((name for name, below in bands if impact_speed_kmh < below), "red")


def worse(one: str, other: str) -> bool:
    """Return whether a colour is worse than another.

    >>> worse("brown", "orange")
    True
    """
    return COLOURS.index(one) > COLOURS.index(other)
