"""Traffic lights at one instant."""

from __future__ import annotations

from typing import Any

from controllers.interface import CrossingKind
from cosim.sumo.network import NetCrossing


class Lights:
    """States of the traffic lights at one instant, each read when the first ego needs it.

    Parameters
    ----------
    sumo : module or connection
    """

    def __init__(self, sumo: Any) -> None:
        self._read = sumo.trafficlight.getRedYellowGreenState
        self._states: dict[str, str] = {}
        self._green: dict[str, bool | None] = {}

    def letter(self, name: str, index: int) -> str:
        """Return SUMO's letter for one signal of a light; empty where there is no light."""
        if not name:
            return ""
        if name not in self._states:
            self._states[name] = self._read(name)
        return self._states[name][index]

    def pedestrians_have_green(self, crossing: NetCrossing) -> bool | None:
        """Return whether a crossing's pedestrians may go; ``None`` where no signal says so."""
        if not crossing.signal:
            return None
        if crossing.name not in self._green:
            letters = self._letters(crossing)
            out_of_order = all(letter in "oO" for letter in letters)
            self._green[crossing.name] = None if out_of_order else any(c in "gG" for c in letters)
        return self._green[crossing.name]

    def kind(self, crossing: NetCrossing) -> CrossingKind:
        """Return who has to wait at a crossing now.

        If its light is switched off, SUMO's letter decides: with ``O`` its pedestrians walk on, with ``o``
        they wait.
        """
        if not crossing.signal or self.pedestrians_have_green(crossing) is not None:
            return crossing.kind
        return CrossingKind.ZEBRA if "O" in self._letters(crossing) else CrossingKind.UNMARKED

    def _letters(self, crossing: NetCrossing) -> list[str]:
        return [self.letter(crossing.signal, index) for index in crossing.signal_indices]
