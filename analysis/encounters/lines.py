"""Distances of a driven rectangle from lines on the ground, such as the centre lines of crossings.

A town has thousands of such lines and a vehicle drives over a few of them, so everything is computed for all
lines of a track at once.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analysis.arrays import FloatArray, IntArray
from analysis.geometry import signed_distance
from analysis.recording.tracks import Track

_SPACING_M = 0.1
_SLACK_M = 1e-6


class Lines:
    """Lines of two or more corners, as points at most 0.1 m apart.

    Parameters
    ----------
    corners : corners of each line, shape (corners, 2) [m]
    half_widths : how far the ground of each line extends to either side, shape (n,) [m]
    """

    def __init__(self, corners: Sequence[FloatArray], half_widths: FloatArray) -> None:
        self.half_widths = half_widths
        self._low = np.array([line.min(axis=0) for line in corners]).reshape(-1, 2) - half_widths[:, None]
        self._high = np.array([line.max(axis=0) for line in corners]).reshape(-1, 2) + half_widths[:, None]
        # The straight pieces of all lines, one after the other.
        self._pieces = np.array([len(line) - 1 for line in corners], dtype=np.int64)
        self._first_piece = np.cumsum(self._pieces) - self._pieces
        start = np.concatenate([np.empty((0, 2)), *(line[:-1] for line in corners)])
        step = np.concatenate([np.empty((0, 2)), *(np.diff(line, axis=0) for line in corners)])
        self._start_x, self._start_y, self._step_x, self._step_y = *start.T, *step.T
        self._length = np.hypot(self._step_x, self._step_y)
        self._intervals = np.maximum(np.ceil(self._length / _SPACING_M), 1.0)

    def near(self, track: Track, margin: float) -> tuple[IntArray, IntArray]:
        """Return the pairs of a line and a sample of the track in the line's box, widened by a margin [m].

        Returns
        -------
        Numbers of the lines, in order, and of the samples, for each line in order.
        """
        x, y = track.x, track.y
        low, high = self._low - margin, self._high + margin
        lines = np.flatnonzero(
            (low[:, 0] <= x.max())
            & (low[:, 1] <= y.max())
            & (high[:, 0] >= x.min())
            & (high[:, 1] >= y.min())
        )
        low, high = low[lines, :, None], high[lines, :, None]
        inside = (x >= low[:, 0]) & (x <= high[:, 0]) & (y >= low[:, 1]) & (y <= high[:, 1])
        line, sample = np.nonzero(inside)
        return lines[line], sample

    def distances(self, track: Track, lines: IntArray, samples: IntArray, beyond: float) -> FloatArray:
        """Return the smallest signed distance from the rectangle to a line's points, pair by pair [m].

        Parameters
        ----------
        track
        lines, samples : the pairs
        beyond : distances above the half width by more may be given too large, up to infinity [m]
        """
        # Combine each pair with each straight piece of its line.
        pieces = self._pieces[lines]
        pair = np.repeat(np.arange(len(lines)), pieces)
        piece = np.arange(len(pair)) + np.repeat(
            self._first_piece[lines] - np.cumsum(pieces) + pieces, pieces
        )
        first, counts = self._points(track, samples[pair], piece, (self.half_widths + beyond)[lines[pair]])
        some = np.flatnonzero(counts > 0)
        smallest = np.full(len(lines), np.inf)
        if len(some) == 0:
            return smallest
        pair, piece, first, counts = pair[some], piece[some], first[some], counts[some]
        starts = np.cumsum(counts) - counts
        number = np.arange(int(counts.sum())) + np.repeat(first - starts, counts)
        piece = np.repeat(piece, counts)
        part = number / self._intervals[piece]
        x, y, heading = (values[samples[pair]] for values in (track.x, track.y, track.heading))
        dx = self._start_x[piece] + self._step_x[piece] * part - np.repeat(x, counts)
        dy = self._start_y[piece] + self._step_y[piece] * part - np.repeat(y, counts)
        cos, sin = np.repeat(np.cos(heading), counts), np.repeat(np.sin(heading), counts)
        distance = signed_distance(
            dx * cos + dy * sin, dy * cos - dx * sin, 0.5 * track.length, 0.5 * track.width
        )
        new = np.concatenate([[True], pair[1:] != pair[:-1]])
        smallest[pair[new]] = np.minimum.reduceat(distance, starts[new])
        return smallest

    def _points(
        self, track: Track, samples: IntArray, piece: IntArray, wanted: FloatArray
    ) -> tuple[IntArray, IntArray]:
        """Return the first point of each piece that may be nearest to the rectangle, and how many may be.

        No point is nearer to the rectangle than its distance from the centre less half the diagonal. The
        point nearest to the centre is no farther from the rectangle than its distance from the centre less
        half the shorter side.
        """
        corner = 0.5 * float(np.hypot(track.length, track.width))
        length, intervals = self._length[piece], self._intervals[piece]
        spacing = np.maximum(length / intervals, _SLACK_M)
        unit = 1.0 / np.maximum(length, _SLACK_M)
        along_x, along_y = self._step_x[piece] * unit, self._step_y[piece] * unit
        dx, dy = track.x[samples] - self._start_x[piece], track.y[samples] - self._start_y[piece]
        along, beside = dx * along_x + dy * along_y, dy * along_x - dx * along_y
        nearest = np.hypot(beside, along - np.clip(along, 0.0, length)) + spacing
        reach = (
            np.minimum(nearest + corner - 0.5 * min(track.length, track.width), corner + wanted) + _SLACK_M
        )
        half_chord = np.sqrt(np.maximum(reach * reach - beside * beside, 0.0))
        first = np.maximum(np.ceil((along - half_chord) / spacing), 0.0)
        last = np.minimum(np.floor((along + half_chord) / spacing), intervals)
        counts = np.where(np.abs(beside) <= reach, last - first + 1.0, 0.0)
        return first.astype(np.int64), np.maximum(counts, 0.0).astype(np.int64)
