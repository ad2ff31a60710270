"""Where people wait, how tight bends are, and what turning cars sweep, on junctions whose shapes are known."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest

from cosim.inspection import geometry
from cosim.inspection.finding import Level
from cosim.inspection.inspection import inspect
from cosim.inspection.options import step_length
from cosim.inspection.scaffold import write_scaffold
from cosim.inspection.source import read_source
from cosim.sumo.network import Network, WalkingArea
from cosim.sumo.network_file import read_network
from cosim.sumo.path import Path
from tests.cosim.inspection.towns import CROSSINGS, WALKS, build, configure

CROSSED = (*WALKS, *CROSSINGS, "--no-turnarounds")


@pytest.fixture(scope="module")
def town(tmp_path_factory: pytest.TempPathFactory) -> Network:
    return read_network(build(tmp_path_factory.mktemp("town"), *CROSSED))


def changed(town: Network, **parts: object) -> Network:
    own = {key: getattr(town, key) for key in ("lanes", "edges", "connections", "crossings", "walking_areas")}
    return Network(**(own | parts))


@pytest.fixture(scope="module")
def from_kerb_to_kerb(town: Network) -> Network:
    """The town with crossings that reach 2.5 m further at either end than netconvert makes them."""
    longer = {}
    for name, crossing in town.crossings.items():
        first, last = crossing.axis[0], crossing.axis[-1]
        more = 2.5 * (last - first) / np.hypot(*(last - first))
        longer[name] = replace(crossing, axis=np.array([first - more, last + more]))
    return changed(town, crossings=longer)


def test_people_wait_beside_the_road_where_crossings_go_from_kerb_to_kerb(
    from_kerb_to_kerb: Network,
) -> None:
    town = from_kerb_to_kerb
    (found,) = geometry.waiting_places(town)
    assert found.level is Level.GOOD
    assert found.text == f"none of {2 * len(town.crossings)} is in a car lane"


def test_a_crossing_that_ends_on_a_car_lane_is_named(from_kerb_to_kerb: Network) -> None:
    town = from_kerb_to_kerb
    name, crossing = next(iter(town.crossings.items()))
    short = replace(crossing, axis=np.array([crossing.axis[0], 0.5 * (crossing.axis[0] + crossing.axis[-1])]))
    (found,) = geometry.waiting_places(changed(town, crossings={**town.crossings, name: short}))
    assert found.level is Level.NOTE
    assert f"1 of {2 * len(town.crossings)}" in found.text
    assert name in found.text
    assert "netedit" in found.text


def test_people_wait_in_a_row_before_the_crossing(town: Network) -> None:
    crossing = replace(
        next(iter(town.crossings.values())), axis=np.array([[0.0, 0.0], [10.0, 0.0]]), width=4.0
    )
    assert geometry.waiting_at(crossing, -1).tolist() == [
        [pytest.approx(10.3), pytest.approx(y)] for y in (-1.68, 0.0, 1.68)
    ]


def test_bends_that_no_car_can_drive_are_named(town: Network) -> None:
    (good,) = geometry.tight_bends(town)
    assert good.level is Level.GOOD
    connection = next(one for group in town.connections.values() for one in group if one.direction == "l")
    start = town.lanes[connection.source].shape[-1]
    end = town.lanes[connection.target].shape[0]
    way = town.lanes[connection.source].shape[-1] - town.lanes[connection.source].shape[0]
    corner = start + way / np.hypot(*way) * abs((end - start) @ way) / np.hypot(*way)
    via = town.lanes[connection.via[0]]
    sharp = replace(via, shape=np.array([start, corner, end]))
    part = replace(connection, via=(via.name,))
    lanes = {**town.lanes, via.name: sharp}
    (bad,) = geometry.tight_bends(changed(town, lanes=lanes, connections={connection.source: (part,)}))
    assert "1 of 1 junction movements" in bad.text
    assert "netconvert --default.junctions.radius" in bad.text


def test_a_walking_area_in_the_way_of_a_turning_car_is_named(town: Network) -> None:
    (good,) = geometry.swept_walking_areas(town)
    assert good.level is Level.GOOD
    via = next(one.via[0] for group in town.connections.values() for one in group if one.direction == "l")
    x, y = town.lanes[via].shape[len(town.lanes[via].shape) // 2]
    outline = np.array([[x - 1, y - 1], [x + 1, y - 1], [x + 1, y + 1], [x - 1, y + 1]])
    area = WalkingArea(f":{via[1:].rsplit('_', 2)[0]}_w99", outline)
    (bad,) = geometry.swept_walking_areas(changed(town, walking_areas={area.name: area}))
    assert via in bad.text


def test_a_car_that_turns_sweeps_more_than_its_width() -> None:
    angle = np.linspace(0.0, math.pi, 100)
    path = Path(10.0 * np.column_stack([np.cos(angle), np.sin(angle)]))
    corners = geometry.swept(path)
    # Not near the ends, where the curve goes on straight.
    reach = np.hypot(*corners[(corners[:, 1] > 6.0)].T)
    # Its front outer corner, 0.2 m inside the body: 3.35 m before the rear axle and 0.7 m beside the path.
    assert reach.max() == pytest.approx(math.hypot(10.7, 3.35), abs=0.1)
    assert reach.min() == pytest.approx(9.3, abs=0.1)


def test_a_step_that_is_not_given_is_said_and_the_scaffold_sets_one(tmp_path: File) -> None:
    build(tmp_path, *CROSSED)
    path = configure(tmp_path)
    path.write_text(path.read_text().replace('<step-length value="0.1"/>', ""))
    found = step_length(read_source(path))
    assert found.level is Level.NOTE
    assert "none is given" in found.text
    assert "steps above 0.2 s are too coarse to judge conflicts, 0.1 s is recommended" in found.text
    assert "--step-s 0.1" in found.text
    write_scaffold(inspect(path), tmp_path / "made")
    assert '<step-length value="0.1"/>' in (tmp_path / "made" / "town.sumocfg").read_text()


def test_the_scaffold_sets_the_step_that_it_advises(tmp_path: File) -> None:
    build(tmp_path, *CROSSED)
    found = inspect(configure(tmp_path, step="1"))
    assert any("cosim run --step-s 0.1" in one.text for one in found.findings)
    write_scaffold(found, tmp_path / "made")
    assert '<step-length value="0.1"/>' in (tmp_path / "made" / "town.sumocfg").read_text()
