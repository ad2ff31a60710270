"""The table of trajectories: one row for each road user and instant, the same for all layouts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

COLUMNS = (
    "id",
    "kind",
    "time_s",
    "x_m",
    "y_m",
    "heading_rad",
    "speed_mps",
    "length_m",
    "width_m",
)
"""Columns of `Trajectories.frame`, besides ``row``, the sample's row in its file."""
DEGREES = "EPSG:4326"
"""Coordinate system of positions in longitude and latitude."""
BODIES = {
    "car": (4.5, 1.8),
    "van": (5.5, 2.0),
    "truck": (9.0, 2.5),
    "bus": (12.0, 2.5),
    "motorcycle": (2.2, 0.9),
    "bicycle": (1.8, 0.65),
    "pedestrian": (0.5, 0.5),
}
"""Length and width assumed where none were recorded; for a pedestrian, the disc's diameter [m]."""
PEDESTRIAN = "pedestrian"
STANDING_MPS = 0.3
"""Below this speed, a road user has no direction of motion [m/s]."""


@dataclass(frozen=True, slots=True)
class Trajectories:
    """Samples of road users, sorted by id and time; positions are the centres of bodies.

    Angles are in radians, counter-clockwise from east. Lengths and widths may be nan: not recorded.
    """

    frame: pd.DataFrame
    source: str
    """Name of the file, for messages."""
    crs: str | None = None
    """Coordinate system of the positions, as pyproj takes it; ``None`` for the network's own."""
    layout: str = "csv"
    bodies_known: bool = True
    """Whether the recorded lengths and widths are reliable."""
    at_front: bool = False
    """Whether a vehicle's position is the middle of its front bumper."""

    def with_frame(self, frame: pd.DataFrame, crs: str | None) -> Trajectories:
        """Return the same with other samples and another coordinate system."""
        return replace(self, frame=frame, crs=crs)

    def __len__(self) -> int:
        return len(self.frame)


def with_motion(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the samples with speed and heading, computed from the positions where they are not given.

    The velocity is the central difference. A road user who stands keeps their last heading or, before they
    first move, has the first later one; a road user who never moves has heading 0.

    Parameters
    ----------
    frame : sorted by id and time; ``speed_mps`` and ``heading_rad`` may be nan
    """
    given_speed, given_heading = frame["speed_mps"].notna(), frame["heading_rad"].notna()
    if given_speed.all() and given_heading.all():
        return frame
    made = frame.copy()
    speed_x, speed_y = differences(frame, "x_m"), differences(frame, "y_m")
    speed = np.hypot(speed_x, speed_y)
    made["speed_mps"] = frame["speed_mps"].where(given_speed, speed)
    heading = pd.Series(np.arctan2(speed_y, speed_x), index=frame.index)
    heading = heading.where(speed >= STANDING_MPS)
    group = heading.groupby(frame["id"], sort=False)
    heading = group.ffill().fillna(group.bfill()).fillna(0.0)
    made["heading_rad"] = frame["heading_rad"].where(given_heading, heading)
    return made


def differences(frame: pd.DataFrame, column: str) -> NDArray[np.float64]:
    """Return the central differences of a column over time for each road user [1/s]; 0 for a single sample.

    Examples
    --------
    >>> frame = pd.DataFrame({"id": ["a"] * 3, "time_s": [0.0, 1.0, 2.0], "x_m": [0.0, 1.0, 4.0]})
    >>> differences(frame, "x_m").tolist()
    [1.0, 2.0, 3.0]
    """
    codes = pd.factorize(frame["id"])[0]
    time = frame["time_s"].to_numpy(np.float64)
    values = frame[column].to_numpy(np.float64)
    index = np.arange(len(frame))
    same = codes[1:] == codes[:-1]
    after = np.where(np.append(same, False), index + 1, index)
    before = np.where(np.append(False, same), index - 1, index)
    span = time[after] - time[before]
    change = values[after] - values[before]
    return np.asarray(np.divide(change, span, out=np.zeros(len(frame)), where=span > 0.0))
