"""Why samples of real tracks do not fit the network: ``python -m studies.validation.misses`` prints tables.

The aims are those of `cosim.tracks.fit`: a moving car within 1.0 m of a lane's axis and 20° of its heading, a
pedestrian within 0.5 m of their ground. Each sample that misses its aim is counted under the first cause that
applies.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

from analysis.markdown import table_of
from analysis.trajectories import dlr
from analysis.trajectories.table import PEDESTRIAN
from cosim.tracks.fit import GROUND_M, LANE_DEG, LANE_M, MOVING_MPS
from cosim.tracks.judging import OnNetwork, TracksRequest, read_on_network
from cosim.tracks.lanes import LaneMatcher, Walkways
from cosim.validation.site import read_site

CHANGING_S = 2.0
"""A car changes lanes this long before and after its nearest lane changes within the same edge [s]."""
DRAWN_M = 0.5
"""Beyond this median distance of cars from its axis, a lane is drawn elsewhere than they drive [m]."""
CHANGING, DRAWN, INSIDE = (
    "changing lanes",
    "the lane is drawn elsewhere than cars drive",
    "within its wide lane",
)
HEADING, ELSE = "heading more than 20° off", "none of these"


def cars(found: OnNetwork) -> pd.DataFrame:
    """Return samples of moving cars with ``missed``, ``cause`` and ``inside``: within the lane's width."""
    lanes = found.network.lanes
    frame = found.placed.frame
    frame = frame[frame["kind"] == "car"].reset_index(drop=True)
    own = [lanes.get(place) for place in frame["place"]]
    edge = pd.Series(["" if lane is None else lane.edge for lane in own])
    width = np.array([0.0 if lane is None else lane.width for lane in own])
    positions = (frame[name].to_numpy() for name in ("x_m", "y_m", "heading_rad"))
    angle = LaneMatcher(found.network, "car").match(*positions).angle
    before = frame.groupby("id")["place"].shift().fillna(frame["place"])
    edge_before = edge.groupby(frame["id"]).shift().fillna(edge)
    change = ((before != frame["place"]) & (edge_before == edge)).astype(float)
    window = 2 * round(CHANGING_S / found.step_s) + 1
    near = change.groupby(frame["id"]).transform(lambda one: one.rolling(window, 1, center=True).max())
    moving = frame["speed_mps"].to_numpy() > MOVING_MPS
    across = frame["across_m"]
    usual = across[moving].groupby(frame["place"][moving]).median()
    usual_here = frame["place"].map(usual).fillna(0.0).to_numpy()
    turned = np.abs(angle) > np.radians(LANE_DEG)
    far = np.abs(across.to_numpy())
    inside = far <= 0.5 * width
    drawn = (np.abs(usual_here) > DRAWN_M) & (np.abs(across.to_numpy() - usual_here) <= LANE_M)
    cause = np.select(
        [turned, near.to_numpy() > 0.0, drawn, inside], [HEADING, CHANGING, DRAWN, INSIDE], ELSE
    )
    made = pd.DataFrame(
        {"missed": (far > LANE_M) | turned | np.isnan(far), "cause": cause, "inside": inside & ~turned}
    )
    return made[moving]


def pedestrians(found: OnNetwork) -> pd.DataFrame:
    """Return samples of pedestrians with ``missed``, ``cause`` and ``away``: distance to their ground [m]."""
    frame = found.placed.frame
    people = frame[frame["kind"] == PEDESTRIAN].reset_index(drop=True)
    nearest, away = Walkways(found.network).nearest(people["x_m"].to_numpy(), people["y_m"].to_numpy())
    names = Walkways(found.network).names
    cause = [
        "beside a crossing"
        if names[one] in found.network.crossings
        else "beside a walking area"
        if names[one] in found.network.walking_areas
        else "beside a sidewalk"
        for one in nearest
    ]
    return pd.DataFrame({"id": people["id"], "missed": away > GROUND_M, "cause": cause, "away": away})


def tables(found: OnNetwork) -> str:
    """Return the page's text about samples that miss their aim."""
    driving, walking = cars(found), pedestrians(found)
    whole = driving["inside"].mean()
    worst = walking.groupby("id")["missed"].sum().sort_values()
    return (
        f"Samples of moving cars that miss the aim, by cause:\n\n{_causes(driving)}\n\n"
        f"{100 * whole:.1f} % of all samples are within the width of their lane and "
        f"{LANE_DEG:g}° of its heading: the lanes of this network are up to 4.4 m wide, and real cars do not "
        "keep to the axis.\n\n"
        f"Samples of pedestrians that miss the aim:\n\n{_causes(walking)}\n\n"
        f"These are {walking['missed'].sum()} samples of {walking['id'][walking['missed']].nunique()} "
        f"people, {worst.iloc[-1]} of one; they are {walking['away'][walking['missed']].median():.1f} m from "
        "their ground in the median: people walk beside the strips by which the network draws crossings."
    )


def _causes(samples: pd.DataFrame) -> str:
    missed = samples[samples["missed"]]
    counts = missed["cause"].value_counts().sort_index().sort_values(ascending=False, kind="stable")
    return table_of(
        [
            {"cause": cause, "samples": count, "of all [%]": f"{100 * count / len(samples):.1f}"}
            for cause, count in counts.items()
        ]
    )


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        site = read_site("braunschweig", Path(folder))
        print(tables(read_on_network(TracksRequest(dlr.PACKAGED, site.net_file))))
