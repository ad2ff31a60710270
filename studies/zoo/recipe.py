"""What a network of the zoo is, before it is made."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

NET = "town.net.xml"
"""Every network's file."""


USUAL_KM = 7.0
"""Length of streets that the periods of a demand are for; in longer ones more set out [km]."""
MOST_TIMES = 3.0
"""As many times more at most."""


@dataclass(frozen=True, slots=True)
class Demand:
    """How many cars and people ``randomTrips.py`` sends on their way, and how."""

    car_period_s: float = 3.0
    """Mean time between two cars, in a town of up to `USUAL_KM` [s]."""
    person_period_s: float = 1.4
    """Mean time between two pedestrians there [s]."""
    car_options: tuple[str, ...] = ("--min-distance", "200")
    person_options: tuple[str, ...] = ("--max-distance", "700")
    forgiving: bool = False
    """Whether trips without a route are left out instead of ending the run."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """One network: its name in tables and commands, and how it is made."""

    name: str
    what: str
    """What is special about it, for the table."""
    make: Callable[[Path, random.Random], None]
    """Writes ``town.net.xml`` into a folder; the generator decides everything random."""
    demand: Demand = field(default_factory=Demand)
    run_factor: int = 1
    """How many times as many runs it has as others, because egos seldom meet anybody there."""
    configuration: str | None = None
    """Path of the configuration that ``make`` has written, where the demand is there already."""
    own_options: str = ""
    """XML that the configuration of the network holds beside input and time."""

    @property
    def as_it_is(self) -> bool:
        """Whether somebody else's configuration is run as they wrote it."""
        return self.configuration is not None
