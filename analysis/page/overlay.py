"""A controller's overlay in the world: points, lines and outlines for the replay.

An overlay is written in the route frame of the ego at the time of the plan. Its entry ``reference_line_m`` is
the axis of that frame. The parts of a name say how to draw it, so that the overlay of a new controller is
drawn without a change here:

- ``x_along`` with ``x_across``: points, with times if there are ``x_enter_s`` and ``x_leave_s``;
- a name with ``path``, ``candidate`` or ``option``: a line of (along, across), or several lines of one
  plan's length if the number of points is a multiple of it;
- a name with ``space``, ``area``, ``cone`` or ``ellipse``: a closed outline; each ellipse has 17 points;
- any other name: points of (along, across).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from analysis.arrays import FloatArray

REFERENCE_LINE = "reference_line_m"
_BEHIND_M, _SPACING_M = 10.0, 5.0
_LINES = ("path", "candidate", "option")
_OUTLINES = ("space", "area", "cone", "ellipse")
_POINTS_OF_ELLIPSE = 17


def drawings(overlay: str, horizon: int) -> list[dict[str, Any]]:
    """Return the drawings of one plan in world coordinates.

    Parameters
    ----------
    overlay
        As recorded: JSON that maps names to lists of numbers.
    horizon
        Number of points of the plan.

    Returns
    -------
    list of dict
        ``name``, ``kind`` (``points``, ``line`` or ``outline``) and ``at`` (x, y, x, y, …) [m]; points may
        have ``label``. Empty without a reference line, which older recordings lack.
    """
    values: dict[str, list[float | None]] = json.loads(overlay) if overlay else {}
    line = values.pop(REFERENCE_LINE, None)
    if not line:
        return []
    axis = np.array(line, dtype=np.float64).reshape(-1, 2)
    found = []
    for name, kind, points, labels in _shapes(values, horizon):
        keep = np.asarray(np.isfinite(points).all(axis=1), dtype=np.bool_)
        if not keep.any():
            continue
        at = to_world(points[keep], axis)
        one: dict[str, Any] = {"name": name, "kind": kind, "at": np.round(at, 2).ravel().tolist()}
        if labels:
            one["label"] = [text for text, kept in zip(labels, keep.tolist(), strict=True) if kept]
        found.append(one)
    return found


def to_world(points: FloatArray, axis: FloatArray) -> FloatArray:
    """Return points (along, across) in world coordinates, given an axis of points 5 m apart.

    Examples
    --------
    The axis leads east from its point for along = −10 m:

    >>> axis = np.column_stack((np.arange(90.0, 121.0, 5.0), np.full(7, 2.0)))
    >>> to_world(np.array([[4.0, 1.5]]), axis).tolist()
    [[104.0, 3.5]]
    """
    place = (points[:, 0] + _BEHIND_M) / _SPACING_M
    piece = np.clip(np.floor(place).astype(np.int64), 0, len(axis) - 2)
    step = axis[piece + 1] - axis[piece]
    length = np.maximum(np.hypot(step[:, 0], step[:, 1]), 1e-9)[:, None]
    left = np.column_stack((-step[:, 1], step[:, 0])) / length
    return np.asarray(axis[piece] + (place - piece)[:, None] * step + points[:, 1:] * left)


def _shapes(
    values: Mapping[str, list[float | None]], horizon: int
) -> Iterator[tuple[str, str, FloatArray, list[str]]]:
    for name, numbers in sorted(values.items()):
        stem, _, last = name.rpartition("_")
        if last == "along" and f"{stem}_across" in values:
            across = values[f"{stem}_across"]
            if len(across) == len(numbers):
                points = np.column_stack((_array(numbers), _array(across)))
                yield stem, "points", points.reshape(-1, 2), _times(values, stem, len(numbers))
        elif last == "across" and f"{stem}_along" in values:
            continue
        elif last == "s" or len(numbers) % 2 or not numbers:
            continue  # times, or nothing that can be drawn
        else:
            points = _array(numbers).reshape(-1, 2)
            plain = name.removesuffix("_m").rstrip("0123456789").rstrip("_").replace("_", " ")
            if any(part in name for part in _LINES):
                for piece in _cut(points, horizon):
                    yield plain, "line", piece, []
            elif any(part in name for part in _OUTLINES):
                for piece in _cut(points, _POINTS_OF_ELLIPSE if "ellipse" in name else len(points)):
                    yield plain, "outline", piece, []
            else:
                yield plain, "points", points, []


def _cut(points: FloatArray, length: int) -> list[FloatArray]:
    """Return the points in pieces of ``length``, or in one piece if their number is no multiple of it."""
    if length < 2 or len(points) % length:
        return [points]
    return np.split(points, len(points) // length)


def _times(values: Mapping[str, list[float | None]], stem: str, count: int) -> list[str]:
    enter, leave = values.get(f"{stem}_enter_s", []), values.get(f"{stem}_leave_s", [])
    if len(enter) != count or len(leave) != count:
        return []
    return [f"{_time(one)}–{_time(other)} s" for one, other in zip(enter, leave, strict=True)]


def _time(value: float | None) -> str:
    return "" if value is None else f"{value:.1f}"


def _array(numbers: list[float | None]) -> FloatArray:
    return np.array([np.nan if value is None else value for value in numbers], dtype=np.float64)
