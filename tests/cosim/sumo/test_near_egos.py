"""In which frame an ego is told of a pedestrian at a crossing."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from controllers.interface import Body
from cosim.step.plant import CAR_DRIVE, Plant
from cosim.sumo.gaps import LaneLine, extents, neighbour_gaps
from cosim.sumo.near_egos import NearEgos
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from cosim.sumo.road_users import Cars, Persons
from cosim.sumo.route import Route
from cosim.sumo.surroundings import Surroundings
from cosim.sumo.track import Track
from cosim.sumo.view import Frame

from . import built

NOBODY = np.zeros((0, 2))
NONE = np.zeros(0)
NO_CARS = Cars((), NOBODY, NOBODY, NONE, NONE, NONE, NONE, NONE, (), NONE, (), ())


@pytest.mark.parametrize(
    ("velocity", "on_crossing", "straight"),
    [
        ((0.2, 1.2), False, False),
        ((1.2, 0.2), False, True),
        ((0.0, 0.2), False, True),
        ((0.2, 1.2), True, True),
    ],
    ids=["along the road", "across it", "standing", "on the crossing"],
)
def test_who_walks_up_to_a_crossing_along_the_road_is_told_of_where_the_bend_before_it_is(
    town: Network, velocity: tuple[float, float], on_crossing: bool, straight: bool
) -> None:
    """Behind a right turn: the straight frame of the crossing leads beside the bend."""
    track = Track(Route(town, ["mj", "js"], "passenger"), 0, 1)
    (x, y), *_ = track.path.curve.at(np.array([135.0]), np.array([0.0]))
    track.update(float(x), float(y))
    body = Body()
    frame = Frame(Plant(body, CAR_DRIVE, float(x) - body.front, float(y), 0.0, 5.0), track)
    crossing = next(one for one in track.path.crossings if one.source.name == ":j_c2")
    place = np.array([[296.0, 191.0]])
    persons = Persons(
        ("p",), place, np.array([velocity]), (":j_w1",), (":j_c2",), np.array([on_crossing]), ("",), ("",)
    )
    nobody, first = np.zeros(0, dtype=np.int64), np.zeros(1, dtype=np.int64)
    near = NearEgos(("ego",), (frame,), Surroundings(persons, NO_CARS, {"ego": first}, {"ego": nobody}))
    told = near.pedestrians_of(0, [crossing])
    along, across, _ = track.path.curve.project(place)
    apart = place[0] - crossing.origin
    forward = np.array([math.cos(crossing.heading), math.sin(crossing.heading)])
    in_bend = float(along[0] - frame.origin), float(across[0])
    beside = crossing.middle - frame.origin + apart @ forward, apart @ np.array([-forward[1], forward[0]])
    assert math.dist(in_bend, beside) > 0.3
    assert (told.along[0], told.across[0]) == pytest.approx(beside if straight else in_bend)
    assert told.on_crossing[0] == on_crossing
    assert told.waiting[0] != on_crossing


def test_a_vehicle_between_two_passages_of_the_path_reaches_over_neither(tmp_path: Path) -> None:
    """On a way round a block that comes to the same junction twice, its ends are nearer to different ones."""
    places = {
        "w": (0, 150),
        "j": (150, 150),
        "e": (200, 150),
        "ne": (200, 200),
        "n": (150, 200),
        "s": (150, 0),
    }
    nodes = "".join(f'<node id="{name}" x="{x}" y="{y}"/>' for name, (x, y) in places.items())
    ways = [("w", "j"), ("j", "e"), ("e", "ne"), ("ne", "n"), ("n", "j"), ("j", "s")]
    edges = "".join(f'<edge id="{a}{b}" from="{a}" to="{b}"/>' for a, b in ways)
    network = read_network(built.network(tmp_path, nodes, edges))
    track = Track(Route(network, [a + b for a, b in ways], "passenger"), 0, 0)
    (x, y), *_ = track.path.curve.at(np.array([80.0]), np.array([0.0]))
    track.update(float(x), float(y))
    body = Body()
    frame = Frame(Plant(body, CAR_DRIVE, float(x) - body.front, float(y), 0.0, 5.0), track)
    # South-east of the junction: its front is on the right of the first passage, its rear left of the second.
    place, heading, length = np.array([[171.0, 129.5]]), np.array([0.25 * math.pi]), np.array([5.0])
    one, still = np.zeros(1), np.zeros((1, 2))
    cars = Cars(("car",), place, still, heading, one, one, length, one + 1.8, ("",), one, ("",), ("",))
    persons = Persons((), NOBODY, NOBODY, (), (), np.zeros(0, dtype=bool), (), ())
    nobody, first = np.zeros(0, dtype=np.int64), np.zeros(1, dtype=np.int64)
    near = NearEgos(("ego",), (frame,), Surroundings(persons, cars, {"ego": nobody}, {"ego": first}))
    assert near.vehicles.across[0] < -15.0
    covered = extents(near.vehicles, near.back_along, near.back_across)
    ego = (-body.rear_overhang, body.front)
    (gaps,) = neighbour_gaps(near.vehicles, covered, near.car_starts, [{0: LaneLine(3.2)}], [ego])
    assert gaps.ahead is None
