"""Corners of a polyline made round.

SUMO draws a curve as a few chords: five points for a turn in a junction. Taken at its word, such a line is
straight and then bends sharply, and a driver would slow down for each of its corners.
"""

from __future__ import annotations

import numpy as np

from analysis.polylines import arc_lengths
from cosim.arrays import FloatArray

DEVIATION = 0.4
"""The curve passes a corner of the polyline at most this far away [m]."""
SLIGHT = np.radians(1.0)
"""Corners of less than this slow nobody down [rad]."""
POINTS = 9
"""Number of points of the polyline that a corner becomes."""


def rounded(polyline: FloatArray, knots: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return points and knots of a polyline whose corners are parabolas.

    Each parabola begins and ends on the polyline, no farther from its corner than halfway to the next one, so
    chords of a curve become the curve. Stations do not change.

    Parameters
    ----------
    polyline : (n, 2) [m]
    knots : station of each point, (n,) [m]
    """
    chords = np.diff(polyline, axis=0)
    turns = np.diff(np.unwrap(np.arctan2(chords[:, 1], chords[:, 0])))
    corners = np.flatnonzero(np.abs(turns) > SLIGHT) + 1
    if not len(corners):
        return polyline, knots
    along = arc_lengths(polyline)
    halves = 0.5 * np.diff(along[np.concatenate([[0], corners, [len(polyline) - 1]])])
    reach = np.minimum(halves[:-1], halves[1:])
    reach = np.minimum(reach, DEVIATION / np.tan(0.25 * np.abs(turns[corners - 1])))
    lows, highs = along[corners] - reach, along[corners] + reach
    begins, ends = (
        np.column_stack([np.interp(at, along, polyline[:, axis]) for axis in (0, 1)]) for at in (lows, highs)
    )
    parts, places = [], []
    done = 0.0
    share = np.linspace(0.0, 1.0, POINTS)[:, None]
    for corner, low, high, begin, end in zip(corners, lows, highs, begins, ends, strict=True):
        straight = (along >= done) & (along < low)
        parts += [
            polyline[straight],
            (1.0 - share) ** 2 * begin + 2.0 * share * (1.0 - share) * polyline[corner] + share**2 * end,
        ]
        places += [along[straight], low + share[:, 0] * (high - low)]
        done = high
    rest = along > done
    points = np.concatenate([*parts, polyline[rest]])
    stations = np.interp(np.concatenate([*places, along[rest]]), along, knots)
    apart = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-6])
    return points[apart], stations[apart]
