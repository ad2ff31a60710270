"""Routes, and the paths along their lanes."""

import math
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sumo

from controllers.interface import CrossingKind
from cosim.errors import InputError
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from cosim.sumo.route import Route


def test_lanes_know_how_far_they_lead(town: Network) -> None:
    route = Route(town, ["am", "mj", "jn"], "passenger")
    assert math.isinf(route.reach(1, 3))
    assert route.reach(1, 2) == pytest.approx(town.lanes["mj_2"].length, abs=0.1)
    assert route.next_lane(0, 2) == 3
    assert math.isinf(route.reach(0, 2))
    assert route.reach(0, 1) == pytest.approx(293.6, abs=0.5)


def test_a_zebra_lies_where_the_network_says(town: Network) -> None:
    path = Route(town, ["am", "mj", "jb"], "passenger").path(0, 1)
    zebra = path.crossings[0]
    assert zebra.kind is CrossingKind.ZEBRA
    assert zebra.exit - zebra.entry == pytest.approx(4.0, abs=0.5)
    world = path.curve.at(np.array([zebra.middle]), np.zeros(1))[0]
    assert world[0] == pytest.approx(town.crossings[":m_c0"].axis[0, 0], abs=0.05)
    # Four lanes of 3.2 m and the walk: the kerb is right of the right lane and left of all the others.
    assert zebra.left - zebra.right == pytest.approx(16.0, abs=1.0)
    assert -3.0 < zebra.right < -1.0
    assert zebra.stop_line <= min(zebra.entry - 1.0, path.edge_end)


def test_a_left_turn_meets_both_crossings_and_stops_inside_the_junction_for_the_second(town: Network) -> None:
    path = Route(town, ["mj", "jn"], "passenger").path(0, 3)
    near, far = (crossing for crossing in path.crossings if crossing.kind is CrossingKind.SIGNAL)
    assert near.stop_line < near.entry < path.next_start
    assert near.stop_line <= path.edge_end
    assert path.edge_end < far.stop_line < far.entry
    assert far.heading == pytest.approx(math.pi / 2, abs=0.3)


def test_signals_and_limits_are_where_the_lane_ends(town: Network) -> None:
    path = Route(town, ["mj", "jn"], "passenger").path(0, 3)
    (signal,) = path.signals
    assert signal.name == "j"
    assert signal.stop_line == pytest.approx(path.edge_end)
    starts, limits = path.limits
    assert limits[-1] == pytest.approx(8.33)
    assert starts[-1] == pytest.approx(path.next_start, abs=0.1)
    assert path.leads_to_end


def test_a_path_goes_on_behind_its_edge(town: Network) -> None:
    path = Route(town, ["am", "mj", "jb"], "passenger").path(1, 1)
    assert path.pieces[0].lane.edge == "am"
    assert path.pieces[0].start < -100.0


def test_a_lane_that_begins_on_an_edge_has_a_way_behind_it(town: Network) -> None:
    route = Route(town, ["am", "mj", "jb"], "passenger")
    for index in (1, 2, 3):
        path = route.path(1, index)
        behind = path.curve.at(np.array([-40.0]), np.zeros(1))[0]
        assert behind[0] == pytest.approx(path.own.lane.shape[0, 0] - 40.0, abs=1.5)


def test_neighbouring_lanes_are_a_lane_width_apart(town: Network) -> None:
    route = Route(town, ["mj", "jb"], "passenger")
    offsets = route.path(0, 1).beside(route.path(0, 2))
    inside = (route.path(0, 1).curve.along > 20.0) & (route.path(0, 1).curve.along < 120.0)
    assert offsets[inside] == pytest.approx(3.2, abs=0.01)


BLOCK = ["B2B1", "B1B0", "B0C0", "C0C1", "C1C2", "C2B2", "B2B1"]


@pytest.fixture(scope="module")
def blocks(tmp_path_factory: pytest.TempPathFactory) -> Network:
    """Small blocks with lights and crossings, two lanes a direction."""
    file = tmp_path_factory.mktemp("blocks") / "town.net.xml"
    grid = ["--grid", "--grid.number=3", "--grid.length=50", "--default.lanenumber=2"]
    lights = ["--default-junction-type=traffic_light"]
    walks = ["--sidewalks.guess", "--crossings.guess", "--no-turnarounds"]
    netgenerate = Path(sumo.SUMO_HOME) / "bin" / "netgenerate"
    subprocess.run([netgenerate, *grid, *walks, *lights, "-o", file], check=True, capture_output=True)
    return read_network(file)


def test_on_a_way_around_the_block_the_lane_beside_is_there_all_along_the_edge(blocks: Network) -> None:
    """From the end of its edge on the left lane's way leads round the block and back over the same edge."""
    route = Route(blocks, BLOCK, "passenger")
    right, left = route.path(1, 1), route.path(1, 2)
    for path, other, offset in ((right, left, 3.2), (left, right, -3.2)):
        on_it = (path.curve.along > 1.0) & (path.curve.along < path.edge_end - 1.0)
        assert path.beside(other)[on_it] == pytest.approx(offset, abs=0.05)


def test_on_a_way_around_the_block_a_crossing_behind_does_not_hide_that_it_comes_again(
    blocks: Network,
) -> None:
    """The ego sets out over a crossing, which it meets again after four turns."""
    route = Route(blocks, ["B1B0", "B0C0", "C0C1", "C1B1", "B1B0"], "passenger")
    setting_out = min(route.path(0, 2).crossings, key=lambda crossing: abs(crossing.middle))
    (later,) = [c for c in route.path(1, 2).crossings if c.source is setting_out.source]
    assert later.middle > 100.0
    (met,) = [c for c in route.path(3, 2).crossings if c.source is setting_out.source]
    assert met.origin == pytest.approx(setting_out.origin, abs=0.5)
    assert met.stop_line > route.path(3, 2).edge_end, "beyond the junction"


def test_on_a_way_around_the_block_the_light_at_the_end_of_the_edge_is_told(blocks: Network) -> None:
    """The same lane and light come again after four turns."""
    path = Route(blocks, ["B1B0", "B0C0", "C0C1", "C1B1", "B1B0", "B0C0"], "passenger").path(0, 2)
    ahead = [signal.stop_line for signal in path.signals if signal.stop_line > 0.0]
    assert ahead[0] == pytest.approx(path.edge_end)
    assert ahead == sorted(ahead)
    assert len(ahead) == len(set(ahead)) >= 5, "the light of the edge twice"
    assert [junction.start for junction in path.junctions if junction.start > 0.0] == ahead
    assert all(junction.start < junction.end for junction in path.junctions)


@pytest.mark.parametrize(
    ("edges", "said"),
    [
        ([], "at least one edge"),
        (["am", "mk"], 'edge 2 "mk" is not in the network.*"mj"'),
        (["am", ":m_0"], 'edge 2 ":m_0" is not in the network'),
        (["am", "jn"], 'edge 2 "jn" does not follow "am".*after it come "mj"'),
    ],
)
def test_a_bad_route_names_the_edge_and_what_there_is(town: Network, edges: list[str], said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        Route(town, edges, "passenger")
    assert "\n" not in str(caught.value)


def test_a_route_without_a_lane_for_the_class_is_refused(braunschweig: Network) -> None:
    with pytest.raises(InputError, match='"-2" has no lane for a tram'):
        Route(braunschweig, ["-2"], "tram")


def test_a_side_step_between_edges_in_line_is_drawn_out(braunschweig: Network) -> None:
    path = Route(braunschweig, ["-2", "-2.10"], "passenger").path(0, 4)
    assert path.pieces[-2].lane.name == ":J12_0_2"
    assert np.abs(path.curve.curvature).max() < 0.1


def test_every_connected_pair_of_the_measured_intersection_has_paths(braunschweig: Network) -> None:
    pairs = {
        (braunschweig.lanes[source].edge, braunschweig.lanes[connection.target].edge)
        for source, group in braunschweig.connections.items()
        for connection in group
        if braunschweig.passable(connection, "passenger")
        and braunschweig.lanes[source].permissions.allows("passenger")
    }
    assert len(pairs) > 20
    for pair in sorted(pairs):
        route = Route(braunschweig, pair, "passenger")
        for index in braunschweig.allowed_lanes(pair[0], "passenger"):
            path = route.path(0, index)
            assert np.isfinite(path.curve.curvature).all()
            # What is left are turning places of 3 m radius.
            assert np.abs(path.curve.curvature).max() < 0.65
            for crossing in path.crossings:
                assert crossing.stop_line < crossing.entry < crossing.exit
                assert crossing.right < 0.6
                assert crossing.left > -0.6


@pytest.mark.parametrize("short_of_the_lane", [0.0, 1.0, 3.0])
def test_a_crossing_drawn_too_short_for_the_lane_is_on_its_path_all_the_same(
    town: Network, short_of_the_lane: float
) -> None:
    path = Route(town, ["am", "mj", "jb"], "passenger").path(0, 1)
    zebra = town.crossings[":m_c0"]
    whole = path.crossings[0]
    left = path.curve.at(np.array([whole.middle]), np.array([whole.left]))[0]
    beside = path.curve.at(np.array([whole.middle]), np.array([short_of_the_lane]))[0]
    path.meet([replace(zebra, axis=np.array([left, beside]))], [])
    (found,) = path.crossings
    assert found.middle == pytest.approx(whole.middle, abs=0.6)
    assert found.right == pytest.approx(short_of_the_lane, abs=0.1)


def test_a_crossing_beside_the_road_is_not_on_its_path(town: Network) -> None:
    path = Route(town, ["am", "mj", "jb"], "passenger").path(0, 1)
    whole = path.crossings[0]
    axis = path.curve.at(np.array([whole.middle] * 2), np.array([12.0, 8.0]))
    path.meet([replace(town.crossings[":m_c0"], axis=axis)], [])
    assert path.crossings == ()


def test_a_crossing_square_to_the_path_is_met_whatever_rounding_does(town: Network) -> None:
    # The sine of a right angle comes out a little above 1 for some directions.
    path = Route(town, ["am", "mj", "jb"], "passenger").path(0, 1)
    at = path.crossings[0].middle
    heading = path.curve.heading_at(at)
    here = path.curve.at(np.array([at]), np.zeros(1))[0]
    for turn in np.linspace(-1e-7, 1e-7, 400).tolist():
        across = 6.0 * np.array([-math.sin(heading + turn), math.cos(heading + turn)])
        path.meet([replace(town.crossings[":m_c0"], axis=np.array([here - across, here + across]))], [])
        assert len(path.crossings) == 1
