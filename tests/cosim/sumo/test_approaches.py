"""Vehicles before junctions: who is held up in its lane, and who came first to an all-way stop."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import libsumo
import numpy as np
import pytest

from cosim.sumo.approaches import Approaches
from cosim.sumo.foes import FoeFinder
from cosim.sumo.lane_path import PathJunction
from cosim.sumo.lights import Lights
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from cosim.sumo.road_users import Cars

from . import built

LENGTH, WIDTH = 5.0, 1.8


@pytest.fixture(scope="module")
def all_way(all_way_file: Path) -> Network:
    """Crossroads where everybody stops and goes in order of arrival."""
    return read_network(all_way_file)


@pytest.fixture(scope="module")
def no_rule(no_rule_file: Path) -> Network:
    """Crossroads where nobody has to yield."""
    return read_network(no_rule_file)


@pytest.fixture(scope="module")
def all_way_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of the crossroads with all-way stops."""
    return built.grid(tmp_path_factory.mktemp("all_way"), "allway_stop")


@pytest.fixture(scope="module")
def no_rule_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of those without any rule."""
    return built.grid(tmp_path_factory.mktemp("no_rule"), "unregulated")


@pytest.fixture(scope="module")
def zipper_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of crossroads where everybody has to yield to everybody."""
    return built.grid(tmp_path_factory.mktemp("zipper"), "zipper")


def _cars(network: Network, places: Sequence[tuple[str, str, float, float]]) -> Cars:
    """Return vehicles by name, lane, distance from the lane's end [m] and speed [m/s]."""
    names, lanes, left, speeds = zip(*places, strict=True)
    n = len(names)
    position = [network.lanes[lane].length - away for lane, away in zip(lanes, left, strict=True)]
    nothing = np.zeros((n, 2))
    return Cars(
        names,
        nothing,
        nothing,
        np.zeros(n),
        np.array(speeds),
        np.zeros(n),
        np.full(n, LENGTH),
        np.full(n, WIDTH),
        lanes,
        np.array(position),
        ("car",) * n,
        ("",) * n,
    )


def test_who_came_to_an_all_way_stop_before_somebody_goes_first(all_way: Network) -> None:
    approaches = Approaches(all_way)
    south, west = "B0B1_0", "A1B1_0"
    approaches.begin(_cars(all_way, [("ego", south, 3.0, 0.5), ("other", west, 30.0, 9.0)]), 10.0)
    assert approaches.goes_first("ego", "other")
    assert not approaches.goes_first("other", "ego")
    approaches.begin(_cars(all_way, [("ego", south, 2.0, 0.0), ("other", west, 3.0, 0.0)]), 14.0)
    assert approaches.goes_first("ego", "other")
    # Having turned round the block, it comes last.
    approaches.begin(_cars(all_way, [("ego", "B1B2_0", 50.0, 5.0), ("other", west, 3.0, 0.0)]), 20.0)
    approaches.begin(_cars(all_way, [("ego", south, 3.0, 0.0), ("other", west, 3.0, 0.0)]), 60.0)
    assert approaches.goes_first("other", "ego")
    assert not approaches.goes_first("ego", "other")


def test_who_is_inside_an_all_way_stop_goes_before_those_who_wait(all_way: Network) -> None:
    """Somebody let it go first: if it waited for them now, it would stand on the crossing."""
    approaches = Approaches(all_way)
    south, west = "B0B1_0", "A1B1_0"
    (inside,) = next(one for one in all_way.connections[south] if one.target.startswith("B1B2")).via
    approaches.begin(_cars(all_way, [("ego", south, 9.0, 3.0), ("other", west, 3.0, 0.0)]), 10.0)
    approaches.begin(_cars(all_way, [("ego", south, 3.0, 0.0), ("other", west, 3.0, 0.0)]), 14.0)
    assert approaches.goes_first("other", "ego")
    approaches.begin(_cars(all_way, [("ego", inside, 9.0, 1.0), ("other", west, 3.0, 0.0)]), 20.0)
    assert approaches.goes_first("ego", "other")
    assert not approaches.goes_first("other", "ego")
    approaches.begin(_cars(all_way, [("ego", "B1B2_0", 80.0, 5.0), ("other", west, 3.0, 0.0)]), 24.0)
    assert not approaches.goes_first("ego", "other")


def test_nobody_who_is_still_on_the_way_or_not_at_such_a_junction_goes_first(
    all_way: Network, town: Network
) -> None:
    approaches = Approaches(all_way)
    approaches.begin(_cars(all_way, [("ego", "B0B1_0", 20.0, 0.0), ("other", "A1B1_0", 3.0, 8.0)]), 10.0)
    assert not approaches.goes_first("ego", "other")
    assert not approaches.goes_first("other", "ego")
    elsewhere = Approaches(town)
    elsewhere.begin(_cars(town, [("ego", "sj_1", 3.0, 0.0), ("other", "nj_1", 30.0, 8.0)]), 10.0)
    assert not elsewhere.goes_first("ego", "other")


def test_without_any_rule_those_who_wait_go_in_their_order_and_others_are_let_pass(no_rule: Network) -> None:
    approaches = Approaches(no_rule)
    south, west = "B0B1_0", "A1B1_0"
    approaches.begin(_cars(no_rule, [("ego", south, 3.0, 0.5), ("other", west, 3.0, 9.0)]), 10.0)
    assert not approaches.waited_longer("ego", "other")
    assert not approaches.waited_longer("other", "ego")
    approaches.begin(_cars(no_rule, [("ego", south, 2.0, 0.0), ("other", west, 2.0, 0.5)]), 14.0)
    assert approaches.waited_longer("ego", "other")
    assert not approaches.waited_longer("other", "ego")


def test_a_vehicle_is_no_faster_than_those_before_it_in_its_lane(all_way: Network) -> None:
    approaches = Approaches(all_way)
    lane = "A1B1_0"
    cars = [("first", lane, 2.0, 0.0), ("second", lane, 9.0, 0.6), ("other", "B0B1_0", 30.0, 8.0)]
    approaches.begin(_cars(all_way, [*cars, ("third", lane, 20.0, 5.0)]), 0.0)
    assert [approaches.pace(row) for row in range(4)] == [0.0, 0.0, 8.0, 0.0]
    approaches.begin(_cars(all_way, [("third", lane, 20.0, 5.0)]), 0.1)
    assert approaches.pace(0) == 5.0


@pytest.mark.sumo
@pytest.mark.parametrize("ego_first", [True, False])
@pytest.mark.parametrize("kind", ["all_way_file", "no_rule_file", "zipper_file"])
def test_an_ego_yields_to_those_only_who_came_before_it(
    kind: str, ego_first: bool, request: pytest.FixtureRequest
) -> None:
    file = request.getfixturevalue(kind)
    network = read_network(file)
    own = next(one for one in network.connections["B0B1_0"] if one.target.startswith("B1B2"))
    ego, other = ("ego", "B0B1_0", 2.0, 0.0), ("other", "A1B1_0", 2.0, 0.0)
    libsumo.start(["sumo", "-n", str(file), "--no-step-log"])
    try:
        libsumo.route.add("across", ["A1B1", "B1C1"])
        libsumo.vehicle.add("other", "across")
        libsumo.simulationStep()
        finder = FoeFinder(libsumo, network)
        finder.begin(_cars(network, [ego if ego_first else other]), 0.0)
        cars = _cars(network, [ego, other])
        finder.begin(cars, 5.0)
        (foe,) = finder.find("ego", 0.0, [PathJunction(own, 5.0, 20.0)], [1], cars, Lights(libsumo))
    finally:
        libsumo.close()
    assert foe.name == "other"
    assert foe.must_yield is not ego_first
