"""Converts positions of any coordinate system to a network's, with its projection and offset."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from analysis.errors import RecordingError
from analysis.trajectories.checks import sorted_and_checked
from analysis.trajectories.table import DEGREES, Trajectories, with_motion
from cosim.errors import InputError
from cosim.sumo.network_file import opened

NONE = ("!", "-", ".", "")
"""Values of ``projParameter`` that mean that a network has no projection."""


@dataclass(frozen=True, slots=True)
class Location:
    """Where a network lies on the earth."""

    path: Path
    offset: tuple[float, float]
    """Offset added to projected positions [m]."""
    projection: str
    """Projection as a PROJ string; empty for none."""

    def to_degrees(self, x: float, y: float) -> tuple[float, float]:
        """Return longitude and latitude of a place in the network; nan if it has no projection."""
        if not self.projection:
            return np.nan, np.nan
        back = _transformer(self.projection, DEGREES)
        longitude, latitude = back.transform(x - self.offset[0], y - self.offset[1])
        return float(longitude), float(latitude)


def read_location(path: Path) -> Location:
    """Read where a network lies.

    Raises
    ------
    InputError
        If the file cannot be read, or has no ``<location>``.
    """
    try:
        for element in _locations(path):
            x, y = (float(value) for value in element.get("netOffset", "0,0").split(","))
            projection = element.get("projParameter", "!")
            return Location(path, (x, y), "" if projection in NONE else projection)
    except (OSError, ElementTree.ParseError, ValueError) as error:
        raise InputError(f"{path} is not a SUMO network: {error}") from error
    raise InputError(f"{path} is not a SUMO network: it has no <location>")


def _locations(path: Path) -> Iterator[ElementTree.Element]:
    with opened(path) as source:
        for _, element in ElementTree.iterparse(source, events=("start",)):
            if element.tag == "location":
                yield element
                return


def onto_network(found: Trajectories, location: Location) -> Trajectories:
    """Return trajectories in a network's coordinates.

    Headings turn by the angle between the north directions of the two grids; speeds over ground do not
    change.

    Raises
    ------
    InputError
        If the network has no projection and the trajectories need one, or a coordinate system is unknown.
    RecordingError
        If a position has no place in the network's projection, or for positions in degrees as in
        `analysis.trajectories.reading.read_trajectories`.
    """
    if found.crs is None:
        return found
    if not location.projection:
        raise InputError(
            f"{location.path} has no projection, so positions in {found.crs} have no place on it; expected a "
            "network with projParameter, or tracks in the network's own x_m and y_m"
        )
    transform = _transformer(found.crs, location.projection).transform
    frame = found.frame.copy()
    x, y = frame["x_m"].to_numpy(), frame["y_m"].to_numpy()
    new_x, new_y = transform(x, y)
    if not np.isfinite(new_x).all() or not np.isfinite(new_y).all():
        row = int(frame["row"].to_numpy()[int(np.argmin(np.isfinite(new_x) & np.isfinite(new_y)))])
        raise RecordingError(f"{found.source}: row {row}: no place in {location.projection}")
    frame["x_m"], frame["y_m"] = new_x + location.offset[0], new_y + location.offset[1]
    if found.crs == DEGREES:
        frame = with_motion(sorted_and_checked(frame, found.source))
    else:
        frame["heading_rad"] += _turn(transform, x, y)
    return found.with_frame(frame, None)


def _turn(transform: Any, x: np.ndarray, y: np.ndarray) -> float:
    """Return the angle by which directions turn in the middle of the site [rad]."""
    at = float(np.median(x)), float(np.median(y))
    (x0, y0), (x1, y1) = transform(*at), transform(at[0] + 10.0, at[1])
    return float(np.arctan2(y1 - y0, x1 - x0))


def _transformer(source: str, target: str) -> Any:
    try:
        from pyproj import Transformer
        from pyproj.exceptions import ProjError
    except ModuleNotFoundError as error:
        raise InputError("pyproj is not installed; run: pip install pyproj") from error
    try:
        return Transformer.from_crs(source, target, always_xy=True)
    except ProjError as error:
        raise InputError(f"{source} to {target}: no such coordinate system ({error})") from error
