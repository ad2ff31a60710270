"""Which lane a vehicle follows."""

import numpy as np
import pytest

from cosim.sumo.network import Network
from cosim.sumo.route import Route
from cosim.sumo.track import HYSTERESIS, Track


def moved(track: Track, along: float, across: float) -> None:
    """Put the front bumper somewhere on the track's present path."""
    (x, y), *_ = track.path.curve.at(np.array([along]), np.array([across]))
    track.update(float(x), float(y))


def test_a_lane_is_kept_up_to_its_line_and_a_little_further(town: Network) -> None:
    track = Track(Route(town, ["am", "mj", "jb"], "passenger"), 0, 1)
    moved(track, 50.0, 1.6 + 0.5 * HYSTERESIS)
    assert (track.index, track.number) == (1, 0)
    moved(track, 51.0, 1.6 + 2.0 * HYSTERESIS)
    assert (track.index, track.number) == (2, 1)
    assert track.across == pytest.approx(-1.6 + 2.0 * HYSTERESIS, abs=0.01)
    moved(track, 52.0, -1.6 - 0.5 * HYSTERESIS)
    assert (track.index, track.number) == (2, 1)


def test_lanes_are_counted_on_through_junctions(town: Network) -> None:
    track = Track(Route(town, ["am", "mj", "jb"], "passenger"), 0, 2)
    for along in np.arange(100.0, 290.0, 5.0):
        if track.step:
            break
        moved(track, float(along), 0.0)
    assert track.route.edges[track.step] == "mj"
    assert track.number == 0
    assert abs(track.across) < 0.1


def test_a_lane_that_ends_without_a_way_on_is_left_for_the_nearest_that_leads_on(town: Network) -> None:
    track = Track(Route(town, ["mj", "jn"], "passenger"), 0, 2)
    moved(track, 100.0, 0.0)
    assert track.index == 2
    moved(track, track.path.chain_end + 1.0, 0.0)
    assert (track.index, track.number) == (3, 1)
    assert track.across == pytest.approx(-3.2, abs=0.3)


def test_the_end_of_the_route_is_an_arrival(town: Network) -> None:
    track = Track(Route(town, ["mj", "jn"], "passenger"), 1, 1)
    moved(track, track.path.chain_end - 5.0, 0.0)
    assert not track.arrived
    moved(track, track.path.chain_end - 1.0, 0.0)
    assert track.arrived
    assert track.on_last_edge
