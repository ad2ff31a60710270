"""Artificial potential field of a road, and the distances to keep from pedestrians.

The car moves down the gradient of

    U = −K_att x + ½ K_c (y − y_r)² + ½ K_e Σ_j (1 / (y − y_j))² + Σ_l K_l exp(−(y − y_l)² / (2 s²))
        + Σ_o K_o exp(−½ (((x − x_o) / σ_x)² + ((y − y_o) / σ_y)²)),

whose terms draw it onwards (1) and to the centre line of a lane (2), and push it away from the road's edges
(3), from the lines between lanes (4) and from obstacles (5).

Notes
-----
The formulas of [LiLuZhang]_ are lost; these are the forms that its text describes. The paper's own
contribution is the long half-axis of the obstacles' ellipses, which follows from the shift that a car needs
to get past.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from controllers.arrays import FloatArray

NEAREST_EDGE = 0.05
"""The push of an edge does not grow any more at less than this distance from it, or beyond it [m]."""


def side_distance(pedestrian_radius: float, car_width: float, margin: float) -> float:
    """Return the safe lateral distance between the centres of car and pedestrian [m].

    S_ysafe = R_p + W_c / 2 + S_m, Eq. (10) of [LiLuZhang]_.

    >>> round(side_distance(0.3, 1.86, 0.6), 2)
    1.83
    """
    return pedestrian_radius + 0.5 * car_width + margin


def needed_shift(obstacle: FloatArray, centre: float | FloatArray, safe: float | FloatArray) -> FloatArray:
    """Return how far the car has to move to the nearer side [m].

    S_y = max(0, S_ysafe − |y_obs − y_c|), Eq. (9) of [LiLuZhang]_.

    Parameters
    ----------
    obstacle : y_obs [m]
    centre : y_c of the lane that the car would be in [m]; not that of the car itself, which would seem to
        need less shift once it has begun to move over, so that the field would collapse while it is in use
    safe : S_ysafe [m]

    >>> needed_shift(np.array([3.0, 5.0]), 2.0, 1.83).round(2).tolist()
    [0.83, 0.0]
    """
    return np.maximum(safe - np.abs(obstacle - centre), 0.0)


def distance_to_shift(
    speed: float | FloatArray, shift: FloatArray, lateral_acceleration: float
) -> FloatArray:
    """Return how far the car drives while it makes the shift [m].

    S_x = v_c √(2 S_y / a_y), Eq. (8) of [LiLuZhang]_; the form 2 v_c √(S_y / a_y) with twice the
    acceleration is the same.

    >>> distance_to_shift(25.0, np.array([0.83]), 0.3 * 9.80665).round(2).tolist()
    [18.78]
    """
    return np.asarray(speed * np.sqrt(2.0 * shift / lateral_acceleration))


def meeting_time(
    along: FloatArray, along_speed: FloatArray, car_along: float, car_speed: float
) -> FloatArray:
    """Return when car and pedestrian are level, T_cp = (x_p − x_c) / (v_c − v_px); inf if never [s].

    >>> meeting_time(np.array([50.0]), np.array([0.0]), 0.0, 25.0).tolist()
    [2.0]
    """
    closing = car_speed - along_speed
    return np.where(closing > 0.0, (along - car_along) / np.where(closing > 0.0, closing, 1.0), np.inf)


@dataclass(frozen=True, slots=True)
class Gains:
    """Weights of the terms of the field. Each may be an array of the same shape as the points evaluated.

    Notes
    -----
    The paper's values are lost; the defaults were tuned on its four scenes.
    """

    onwards: float | FloatArray = 1.0
    """K_att [1/m]; the other weights are relative to it."""
    centre: float | FloatArray = 0.05
    """K_c [1/m²]."""
    obstacle: float | FloatArray = 0.30
    """K_o."""
    edge: float | FloatArray = 0.02
    """K_e [m²]."""
    line: float | FloatArray = 0.02
    """K_l."""
    line_width: float | FloatArray = 0.5
    """s [m]."""


@dataclass(frozen=True, slots=True)
class Obstacles:
    """Obstacles that push the car away; the last axis of each array runs over the n obstacles.

    If there are two axes, the first runs over the points evaluated: the obstacles may differ from point to
    point, because the points belong to different lanes.
    """

    along: FloatArray
    across: FloatArray
    long_axis: FloatArray
    """σ_x, greater than 0 [m]."""
    side_axis: FloatArray
    """σ_y, greater than 0 [m]."""
    along_speed: FloatArray
    across_speed: FloatArray
    share: FloatArray
    """Share of ``Gains.obstacle``: 1, or 0 where it is no obstacle to that point."""

    def row(self, row: int) -> Obstacles:
        """Return the obstacles of one point, if they differ from point to point; shape (1, n)."""
        one = slice(row, row + 1)
        return Obstacles(
            self.along[one],
            self.across[one],
            self.long_axis[one],
            self.side_axis[one],
            self.along_speed[one],
            self.across_speed[one],
            self.share[one],
        )


NOTHING = Obstacles(*(np.zeros(0) for _ in range(7)))


def standing(along: FloatArray, across: FloatArray, long_axis: FloatArray, side: FloatArray) -> Obstacles:
    """Return obstacles that do not move."""
    still = np.zeros_like(along)
    return Obstacles(along, across, long_axis, side, still, still, np.ones_like(along))


@dataclass(frozen=True, slots=True)
class Field:
    """The potential of a straight road.

    Parameters
    ----------
    right_edge, left_edge : across coordinates of the road's edges [m]
    centre : y_r of the lane's centre line; an array has the shape of the points evaluated [m]
    lines : across coordinates of the lines between lanes, shape (l,) [m]
    obstacles : obstacles with their velocities; their places depend on the time of the evaluation
    gains : weights
    """

    right_edge: float
    left_edge: float
    centre: float | FloatArray
    lines: FloatArray = field(default_factory=lambda: np.zeros(0))
    obstacles: Obstacles = NOTHING
    gains: Gains = field(default_factory=Gains)

    def potential(self, along: FloatArray, across: FloatArray, time: float | FloatArray = 0.0) -> FloatArray:
        """Return U at points, of the points' shape (m,)."""
        gains, obstacles = self.gains, self.obstacles
        to_right, to_left = self._to_edges(across)
        from_line = across[..., None] - self.lines
        width = np.asarray(gains.line_width)[..., None]
        ahead, beside = self._from_obstacles(along, across, time)
        return np.asarray(
            -gains.onwards * along
            + 0.5 * gains.centre * (across - self.centre) ** 2
            + 0.5 * gains.edge * (to_right**-2 + to_left**-2)
            + gains.line * np.exp(-0.5 * (from_line / width) ** 2).sum(axis=-1)
            + gains.obstacle
            * (
                obstacles.share
                * np.exp(-0.5 * ((ahead / obstacles.long_axis) ** 2 + (beside / obstacles.side_axis) ** 2))
            ).sum(axis=-1)
        )

    def gradient(
        self, along: FloatArray, across: FloatArray, time: float | FloatArray = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """Return ∂U/∂x and ∂U/∂y at points, each of the points' shape (m,)."""
        gains, obstacles = self.gains, self.obstacles
        to_right, to_left = self._to_edges(across)
        from_line = across[..., None] - self.lines
        width = np.asarray(gains.line_width)[..., None]
        on_line = np.exp(-0.5 * (from_line / width) ** 2)
        ahead, beside = self._from_obstacles(along, across, time)
        x_share, y_share = ahead / obstacles.long_axis, beside / obstacles.side_axis
        bump = obstacles.share * np.exp(-0.5 * (x_share**2 + y_share**2))
        return (
            -gains.onwards - gains.obstacle * (bump * x_share / obstacles.long_axis).sum(axis=-1),
            gains.centre * (across - self.centre)
            - gains.edge * (to_right**-3 - to_left**-3)
            - gains.line * (on_line * from_line / width**2).sum(axis=-1)
            - gains.obstacle * (bump * y_share / obstacles.side_axis).sum(axis=-1),
        )

    def heading(self, along: FloatArray, across: FloatArray, time: float | FloatArray = 0.0) -> FloatArray:
        """Return the direction of steepest descent at points, shape (m,) [rad]."""
        by_along, by_across = self.gradient(along, across, time)
        return np.arctan2(-by_across, -by_along)

    def row(self, row: int) -> Field:
        """Return the field of one point, if centre line and obstacles differ from point to point."""
        centre = np.asarray(self.centre)[row : row + 1]
        return replace(self, centre=centre, obstacles=self.obstacles.row(row))

    def _to_edges(self, across: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the distances to the right and the left edge, positive inside the road [m]."""
        return (
            np.maximum(across - self.right_edge, NEAREST_EDGE),
            np.maximum(self.left_edge - across, NEAREST_EDGE),
        )

    def _from_obstacles(
        self, along: FloatArray, across: FloatArray, time: float | FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the distances along and across from each obstacle to each point, shape (m, n) [m]."""
        obstacles = self.obstacles
        at = np.asarray(time)[..., None]
        return (
            along[..., None] - obstacles.along - obstacles.along_speed * at,
            across[..., None] - obstacles.across - obstacles.across_speed * at,
        )


def descend(
    shape: Field, along: FloatArray, across: FloatArray, speed: float, step: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return the paths of steepest descent from points, along and across, each of shape (count + 1, m) [m].

    The steps have equal lengths along −∇U / |∇U| and follow the midpoint rule (Runge–Kutta of second order).
    Moving obstacles are placed at the time that the car needs for the length of the path.

    Parameters
    ----------
    shape : the field
    along, across : where the paths begin, shape (m,) [m]
    speed : speed of the car [m/s]
    step : length of a step [m]
    count : number of steps
    """
    rows_along, rows_across = np.zeros((count + 1, len(along))), np.zeros((count + 1, len(along)))
    rows_along[0], rows_across[0] = along, across
    for i in range(count):
        time = i * step / speed
        middle = shape.heading(along, across, time)
        half = 0.5 * step
        heading = shape.heading(
            along + half * np.cos(middle), across + half * np.sin(middle), time + half / speed
        )
        along, across = along + step * np.cos(heading), across + step * np.sin(heading)
        rows_along[i + 1], rows_across[i + 1] = along, across
    return rows_along, rows_across


def curvature(along: FloatArray, across: FloatArray) -> FloatArray:
    """Return the curvature of paths by central differences, along the first axis [1/m]."""
    x, y = np.gradient(along, axis=0), np.gradient(across, axis=0)
    bent = x * np.gradient(y, axis=0) - y * np.gradient(x, axis=0)
    return np.asarray(bent / np.hypot(x, y) ** 3)
