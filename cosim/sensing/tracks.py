"""Tracks of pedestrians: confirmed by repeated detections, filtered, and kept for a while when lost."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosim.arrays import BoolArray, FloatArray

AGILITY = 0.5
"""Assumed spectral density of a pedestrian's acceleration: their speed changes by 0.7 m/s in 1 s [m²/s³]."""


class Tracks:
    """Constant-velocity Kalman filters, one for each pedestrian; both axes are treated alike.

    Parameters
    ----------
    hits, looks : ``hits`` detections within the last ``looks`` looks confirm a track
    hold : a track that has not been detected for longer than this is forgotten [s]
    position_noise, velocity_noise : standard deviations of a measurement along either axis [m, m/s]
    """

    def __init__(
        self, hits: int, looks: int, hold: float, position_noise: float, velocity_noise: float
    ) -> None:
        self._hits, self._looks, self._hold = hits, looks, hold
        self._noise = (position_noise**2, velocity_noise**2)
        self._time = 0.0
        self._row: dict[str, int] = {}
        # x, y, x speed, y speed; variance of position, covariance, variance of speed; time of last detection.
        self._table = np.zeros((0, 8))
        self._history = np.zeros((0, looks), dtype=np.bool_)
        self._confirmed = np.zeros(0, dtype=np.bool_)

    def update(
        self, time: float, names: Sequence[str], detected: BoolArray, measured: FloatArray
    ) -> tuple[BoolArray, FloatArray, FloatArray, FloatArray]:
        """Update the tracks with the detections of this instant.

        Parameters
        ----------
        time : now [s]
        names : all pedestrians who might be detected; tracks of others are forgotten
        detected : (n,) whether each was detected
        measured : (n, 4) position and velocity; used only for those detected [m, m/s]

        Returns
        -------
        confirmed : (n,) whether each has a confirmed track
        estimate : (n, 4) position and velocity now [m, m/s]
        deviation : (n,) standard deviation of the position along either axis [m]
        age : (n,) time since the last detection [s]
        """
        self._align(names)
        table, span = self._table, time - self._time
        known = np.isfinite(table[:, 7])
        table[:, 0:2] += span * table[:, 2:4]
        table[:, 4] += span * (2.0 * table[:, 5] + span * table[:, 6]) + AGILITY * span**3 / 3.0
        table[:, 5] += span * table[:, 6] + 0.5 * AGILITY * span**2
        table[:, 6] += AGILITY * span
        self._correct(np.flatnonzero(known & detected), measured)
        new = ~known & detected
        table[new, 0:4] = measured[new]
        table[new, 4:7] = self._noise[0], 0.0, self._noise[1]
        table[detected, 7] = time
        self._history = np.column_stack([detected, self._history[:, :-1]])
        self._confirmed |= self._history.sum(axis=1) >= self._hits
        forgotten = time - table[:, 7] > self._hold + 1e-9
        table[forgotten, 7] = -np.inf
        self._confirmed &= ~forgotten
        self._time = time
        age = time - table[:, 7]
        return self._confirmed.copy(), table[:, 0:4].copy(), np.sqrt(np.maximum(table[:, 4], 0.0)), age

    def _align(self, names: Sequence[str]) -> None:
        """Rearrange the rows to the order of these names, with new rows for new names."""
        rows = np.array([self._row.get(name, -1) for name in names], dtype=np.int64)
        table = np.zeros((len(names), 8))
        table[:, 7] = -np.inf
        history = np.zeros((len(names), self._looks), dtype=np.bool_)
        confirmed = np.zeros(len(names), dtype=np.bool_)
        old = rows >= 0
        table[old] = self._table[rows[old]]
        history[old] = self._history[rows[old]]
        confirmed[old] = self._confirmed[rows[old]]
        self._table, self._history, self._confirmed = table, history, confirmed
        self._row = {name: row for row, name in enumerate(names)}

    def _correct(self, rows: np.ndarray[tuple[int], np.dtype[np.int64]], measured: FloatArray) -> None:
        """Correct by measurements of position and velocity: K = P (P + R)⁻¹, P ← (1 − K) P."""
        if not len(rows):
            return
        pp, pv, vv = self._table[rows, 4], self._table[rows, 5], self._table[rows, 6]
        spp, svv = pp + self._noise[0], vv + self._noise[1]
        determinant = spp * svv - pv * pv
        from_position = (pp * svv - pv * pv) / determinant
        position_from_speed = (pv * spp - pp * pv) / determinant
        speed_from_position = (pv * svv - vv * pv) / determinant
        from_speed = (vv * spp - pv * pv) / determinant
        off = measured[rows] - self._table[rows, 0:4]
        place, pace = off[:, 0:2], off[:, 2:4]
        self._table[rows, 0:2] += from_position[:, None] * place + position_from_speed[:, None] * pace
        self._table[rows, 2:4] += speed_from_position[:, None] * place + from_speed[:, None] * pace
        self._table[rows, 4] = (1.0 - from_position) * pp - position_from_speed * pv
        self._table[rows, 5] = (1.0 - from_position) * pv - position_from_speed * vv
        self._table[rows, 6] = (1.0 - from_speed) * vv - speed_from_position * pv
