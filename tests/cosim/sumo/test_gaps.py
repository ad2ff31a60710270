"""Who is ahead and behind."""

import math

import numpy as np
import pytest
from shapely import LineString, Polygon

from controllers.interface import NeighbourGaps, Vehicles
from cosim.sumo.gaps import Extents, LaneLine, extents, neighbour_gaps

EGO = (-0.95, 3.55)
WIDTH = 3.2
ALONG = np.array([-200.0, 200.0])
LANES = {
    0: LaneLine(WIDTH),
    1: LaneLine(WIDTH, ALONG, np.array([WIDTH, WIDTH])),
    -1: LaneLine(WIDTH, ALONG, np.array([-WIDTH, -WIDTH])),
}


def on_road(*rows: tuple[float, float, float], length: float = 4.5) -> tuple[Vehicles, Extents]:
    """Return vehicles on a straight road: front bumper along and across [m], heading error [rad]."""
    front = np.array([row[:2] for row in rows]).reshape(-1, 2)
    heading = np.array([row[2] for row in rows])
    back = front - length * np.column_stack([np.cos(heading), np.sin(heading)])
    count = len(rows)
    vehicles = Vehicles(
        tuple(f"v{number}" for number in range(count)),
        front[:, 0],
        0.5 * (front[:, 1] + back[:, 1]),
        10.0 * np.cos(heading),
        10.0 * np.sin(heading),
        np.zeros(count),
        heading,
        np.full(count, length),
        np.full(count, 1.8),
    )
    return vehicles, extents(vehicles, back[:, 0], back[:, 1])


def gaps_of(vehicles: Vehicles, covered: Extents) -> NeighbourGaps:
    """Return the gaps of one ego alone."""
    return neighbour_gaps(vehicles, covered, [0, len(vehicles)], [LANES], [EGO])[0]


def test_gaps_are_between_bumpers() -> None:
    gaps = gaps_of(*on_road((30.0, 0.0, 0.0), (-10.0, 0.0, 0.0)))
    assert gaps.ahead is not None
    assert gaps.behind is not None
    assert gaps.ahead.gap == pytest.approx(30.0 - 4.5 - 3.55)
    assert gaps.behind.gap == pytest.approx(10.0 - 0.95)
    assert gaps.left_ahead is gaps.right_behind is None


def test_a_vehicle_on_a_lane_line_counts_in_both_lanes() -> None:
    gaps = gaps_of(*on_road((30.0, 1.6, 0.0)))
    assert gaps.ahead is not None
    assert gaps.left_ahead is not None
    assert gaps.right_ahead is None


def test_a_vehicle_beside_the_ego_has_a_negative_gap() -> None:
    gaps = gaps_of(*on_road((2.0, 3.2, 0.0)))
    assert gaps.left_behind is not None
    assert gaps.left_behind.gap == pytest.approx(-0.95 - 2.0)


def test_oncoming_vehicles_are_nobodys_neighbours() -> None:
    gaps = gaps_of(*on_road((30.0, 0.0, math.pi), (20.0, 3.2, math.pi)))
    assert gaps.ahead is gaps.left_ahead is None


def test_a_vehicle_across_the_path_is_ahead_in_this_lane_only() -> None:
    gaps = gaps_of(*on_road((30.0, 2.0, math.pi / 2)))
    assert gaps.ahead is not None
    assert gaps.ahead.gap == pytest.approx(30.0 - 0.9 - 3.55)
    assert gaps.left_ahead is gaps.right_ahead is None


def test_nobody_near_is_none() -> None:
    gaps = gaps_of(*on_road())
    assert gaps.ahead is gaps.behind is None


def test_the_gaps_of_several_egos_are_those_of_each_alone() -> None:
    some = (30.0, 0.0, 0.0), (-10.0, 3.2, 0.0), (12.0, 3.0, 0.1)
    everybody, covered = on_road(*some, (9.0, 0.2, 0.0))
    own_lane = {0: LANES[0]}
    found = neighbour_gaps(everybody, covered, [0, 3, 3, 4], [LANES, LANES, own_lane], [EGO] * 3)
    assert found[0] == gaps_of(*on_road(*some))
    assert found[1] == NeighbourGaps()
    assert found[2].ahead is not None
    assert found[2].ahead.name == "v3"
    assert found[2].ahead.gap == pytest.approx(9.0 - 4.5 - EGO[1])
    assert found[2].left_ahead is None


def test_gaps_agree_with_polygons() -> None:
    """Another program as judge: distances between shapely's rectangles, cut by the lane."""
    random = np.random.default_rng(4)
    ego = Polygon([(EGO[0], -0.9), (EGO[1], -0.9), (EGO[1], 0.9), (EGO[0], 0.9)])
    compared = 0
    for _ in range(300):
        rows = [(random.uniform(-80, 80), random.uniform(-6, 6), random.uniform(-0.3, 0.3)) for _ in range(6)]
        vehicles, covered = on_road(*rows)
        gaps = gaps_of(vehicles, covered)
        best = math.inf
        for along, across, heading in rows:
            axis = LineString(
                [(along, across), (along - 4.5 * math.cos(heading), across - 4.5 * math.sin(heading))]
            )
            low, bottom, high, top = axis.buffer(0.9, cap_style="flat").bounds
            if min(top, 1.6) - max(bottom, -1.6) <= 0.1 or low + high <= EGO[0] + EGO[1]:
                continue
            best = min(best, low - ego.bounds[2])
        found = math.inf if gaps.ahead is None else gaps.ahead.gap
        assert found == pytest.approx(best, abs=1e-9)
        compared += math.isfinite(best)
    assert compared > 100
