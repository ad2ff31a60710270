"""Whether an ego has just passed a traffic light, so that it is in a junction that lights control."""

from __future__ import annotations

import math
from dataclasses import dataclass

from controllers.interface import Perception

WITHIN = 40.0
"""An ego that is no farther than this beyond the line of a light is in its junction [m]."""


@dataclass(slots=True)
class LightsPassed:
    """Remembers the last light that one ego has come to."""

    _line: tuple[float, float] | None = None
    """World position of that light's stop line [m]."""

    def look(self, perception: Perception) -> bool:
        """Return whether the ego is in a junction with traffic lights, beyond its stop line."""
        ego = perception.ego
        nearest = min((one.stop_line for one in perception.road.signals), default=math.inf)
        if nearest < ego.body.front + WITHIN:
            self._line = (
                ego.x + nearest * math.cos(ego.heading),
                ego.y + nearest * math.sin(ego.heading),
            )
        if self._line is None or ego.body.front < nearest < ego.body.front + WITHIN:
            return False
        return math.hypot(self._line[0] - ego.x, self._line[1] - ego.y) < WITHIN
