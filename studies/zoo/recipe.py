"""Recipes for the networks of the zoo."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

NET = "town.net.xml"
"""Name of every network's file."""


USUAL_KM = 7.0
"""Length of streets for which the periods of a demand apply; with more streets, demand grows [km]."""
MOST_TIMES = 3.0
"""Largest factor by which the demand grows with the length of the streets."""


@dataclass(frozen=True, slots=True)
class Demand:
    """How many cars and people ``randomTrips.py`` sends on trips, and with which options."""

    car_period_s: float = 3.0
    """Mean time between two cars, in a town of up to `USUAL_KM` [s]."""
    person_period_s: float = 1.4
    """Mean time between two pedestrians in such a town [s]."""
    car_options: tuple[str, ...] = ("--min-distance", "200")
    person_options: tuple[str, ...] = ("--max-distance", "700")
    forgiving: bool = False
    """Whether trips without a route are left out instead of being an error."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """One network: its name in tables and commands, and how it is made."""

    name: str
    what: str
    """What is special about it, for the page."""
    make: Callable[[Path, random.Random], None]
    """Writes ``town.net.xml`` into a folder; the random generator decides everything random."""
    demand: Demand = field(default_factory=Demand)
    run_factor: int = 1
    """Factor on the number of runs, for networks on which egos seldom meet anybody."""
    configuration: str | None = None
    """Path of the configuration that ``make`` writes, if it includes a demand."""
    own_options: str = ""
    """XML in the configuration of the network, in addition to input and time."""

    @property
    def as_it_is(self) -> bool:
        """Whether a ready-made configuration is run unchanged."""
        return self.configuration is not None
