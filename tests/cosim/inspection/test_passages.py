"""Ways over crossings: from every arm, in every direction, with an approach."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.inspection.passages import passages, read_ways
from cosim.inspection.ways import Ways
from tests.cosim.inspection import towns

GUESS = (
    *("--sidewalks.guess", "--sidewalks.guess.max-speed", "14", "--crossings.guess"),
    *("--crossings.guess.speed-threshold", "14", "--no-turnarounds"),
)


@pytest.fixture(scope="module")
def ways(tmp_path_factory: pytest.TempPathFactory) -> Ways:
    folder = tmp_path_factory.mktemp("town")
    return read_ways(towns.build(folder, *GUESS))


def test_every_turn_passes_the_crossings_of_the_arms_that_it_leaves_and_enters(ways: Ways) -> None:
    found = passages(ways, [], 80.0, 300.0)
    # Three arms with a crossing each, six turns, and each turn goes over two of the crossings.
    assert len(ways.network.crossings) == 3
    assert len(found) == 12
    assert {one.manoeuvre for one in found} == {"straight", "left", "right"}
    for one in found:
        assert one.edges[:2] == (one.source, one.target)
        assert 180.0 < ways.length(one.source) < 200.0  # 200 m between nodes, less the junction
        assert one.name == f"{one.crossing} {one.manoeuvre} from {one.source} to {one.target}"
    assert [one.name for one in found] == sorted(one.name for one in found)


def test_roads_are_connected_without_internal_lanes_too(tmp_path: Path, ways: Ways) -> None:
    """Cars of such a network drive from edge to edge, which is no fault of the demand."""
    bare = read_ways(towns.build(tmp_path, "--no-internal-links", "--no-turnarounds"))
    onward = {
        road: {(one.target, one.junction) for one in movements} for road, movements in ways.onward.items()
    }
    found = {road: {(one.target, one.junction) for one in moves} for road, moves in bare.onward.items()}
    assert found == onward
    assert found["east_1"] == {("east_2", "b"), ("north", "b")}


def test_only_the_crossings_that_are_asked_for_and_approaches_that_fit(ways: Ways) -> None:
    first = min(ways.network.crossings)
    assert {one.crossing for one in passages(ways, [first], 80.0, 300.0)} == {first}
    assert passages(ways, [], 80.0, 150.0) == []
    assert passages(ways, [], 250.0, 300.0) == []
