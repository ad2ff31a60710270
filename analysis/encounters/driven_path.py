"""The path of an ego's body by arc length, continued straight on beyond its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.arrays import FloatArray
from analysis.recording.tracks import Track

_SPACING_M = 0.1
_SAME_PLACE_M = 1e-6


@dataclass(frozen=True, slots=True)
class DrivenPath:
    """Poses of a rectangle about 0.1 m apart, in driving order."""

    way: FloatArray
    """Arc length of the centre, as ``Track.path``, ascending [m]."""
    x: FloatArray
    """Centre [m]."""
    y: FloatArray
    heading: FloatArray
    """Unwrapped [rad]."""
    length: float
    width: float

    def at(self, way: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return centre and heading at arc lengths [m, m, rad]."""
        return (
            np.interp(way, self.way, self.x),
            np.interp(way, self.way, self.y),
            np.interp(way, self.way, self.heading),
        )

    def between(self, start: float, end: float) -> DrivenPath:
        """Return the poses between two arc lengths."""
        inside = slice(int(np.searchsorted(self.way, start)), int(np.searchsorted(self.way, end, "right")))
        return DrivenPath(
            self.way[inside],
            self.x[inside],
            self.y[inside],
            self.heading[inside],
            self.length,
            self.width,
        )


def driven_path(ego: Track, beyond_m: float) -> DrivenPath:
    """Return the path that an ego drove, continued in its last direction.

    Parameters
    ----------
    ego : Track
    beyond_m : float
        Length of the continuation [m].
    """
    kept = np.concatenate([[True], np.diff(ego.path) > _SAME_PLACE_M])
    own, x, y, heading = ego.path[kept], ego.x[kept], ego.y[kept], ego.heading[kept]
    count = max(1, int(np.ceil((own[-1] - own[0]) / _SPACING_M)))
    way = np.linspace(own[0], own[-1], count + 1) if len(own) > 1 else own
    ahead = np.arange(_SPACING_M, beyond_m + _SPACING_M, _SPACING_M)
    last = float(heading[-1])
    return DrivenPath(
        way=np.concatenate([way, own[-1] + ahead]),
        x=np.concatenate([np.interp(way, own, x), x[-1] + ahead * np.cos(last)]),
        y=np.concatenate([np.interp(way, own, y), y[-1] + ahead * np.sin(last)]),
        heading=np.concatenate([np.interp(way, own, heading), np.full(len(ahead), last)]),
        length=ego.length,
        width=ego.width,
    )
