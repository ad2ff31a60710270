"""Selection of the samples that a simulation would record: those near crossings."""

from __future__ import annotations

import numpy as np
import pandas as pd

from analysis.trajectories.table import PEDESTRIAN
from cosim.sumo.everybody import PERSON_RANGE, VEHICLE_RANGE, Places
from cosim.sumo.network import Network


def near_crossings(frame: pd.DataFrame, network: Network) -> pd.DataFrame:
    """Return the samples of pedestrians within 20 m and of vehicles within 60 m of a crossing."""
    axes = [crossing.axis for crossing in network.crossings.values()]
    points = frame[["x_m", "y_m"]].to_numpy(np.float64)
    people = (frame["kind"] == PEDESTRIAN).to_numpy()
    near = np.where(people, Places(axes, PERSON_RANGE).hold(points), Places(axes, VEHICLE_RANGE).hold(points))
    return frame[near].reset_index(drop=True)
