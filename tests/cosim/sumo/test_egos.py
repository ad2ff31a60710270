"""How egos come about, as far as no simulation is needed."""

import pytest

from cosim.errors import InputError
from cosim.sumo.egos import EgoSources, drawn
from cosim.sumo.network import NetLane, Network, Permissions
from sumo_scenarios.model import Egos


def test_the_draw_depends_on_seed_and_name_alone_and_is_even() -> None:
    numbers = [drawn(1, f"car{number}") for number in range(2000)]
    assert drawn(1, "car7") == numbers[7]
    assert drawn(2, "car7") != numbers[7]
    assert sum(number < 0.2 for number in numbers) == pytest.approx(400, abs=60)


def test_trips_take_their_routes_in_turn(town: Network) -> None:
    egos = Egos(routes=(("am", "mj"), ("bj", "jm")), count=3, first_depart_s=2.0, headway_s=10.0)
    trips = EgoSources(egos, town, seed=1, start=100.0).trips
    assert [trip.name for trip in trips] == ["ego_0", "ego_1", "ego_2"]
    assert [trip.route.edges[0] for trip in trips] == ["am", "bj", "am"]
    assert [trip.depart for trip in trips] == [102.0, 112.0, 122.0]


def test_a_network_without_roads_for_cars_is_refused(town: Network) -> None:
    walk = town.lanes["am_0"]
    lane = NetLane("p_0", "p", 0, 50.0, 2.0, 2.0, walk.shape, Permissions(frozenset({"pedestrian"})))
    network = Network({"p_0": lane}, {"p": ("p_0",)}, {}, {}, {})
    with pytest.raises(InputError, match="no lane for passenger cars on any of its 1 edges"):
        EgoSources(Egos(share=0.1), network, seed=1, start=0.0)


def test_no_ego_at_all_is_refused(town: Network) -> None:
    with pytest.raises(InputError, match="no ego"):
        EgoSources(Egos(), town, seed=1, start=0.0)
