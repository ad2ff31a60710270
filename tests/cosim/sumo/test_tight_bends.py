"""Egos in junctions whose lanes bend more than a car can: whole runs in SUMO."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from controllers.interface import Body
from cosim.running.request import RunRequest
from cosim.running.simulation import run
from cosim.step.frames import rear_axle_of
from cosim.sumo.network_file import read_network
from cosim.sumo.route import Route

from . import built

pytestmark = pytest.mark.sumo

CORNER = (
    '<node id="w" x="-90" y="0"/><node id="j" x="0" y="0" radius="0"/><node id="s" x="-60" y="-72"/>',
    "",
)
RIGHT_ANGLE = (
    '<node id="w" x="-90" y="0"/><node id="j" x="0" y="0" radius="1"/><node id="s" x="0" y="-90"/>',
    "",
)
FORK = (
    '<node id="w" x="-90" y="0"/><node id="j" x="0" y="0" type="priority" radius="0.2"/>'
    '<node id="e" x="150" y="0"/><node id="s" x="-60" y="-72"/>',
    '<edge id="je" from="j" to="e"/><edge id="ej" from="e" to="j"/>',
)
ROADS = (
    '<edge id="wj" from="w" to="j"/><edge id="jw" from="j" to="w"/>'
    '<edge id="js" from="j" to="s"/><edge id="sj" from="s" to="j"/>'
)


def build(folder: Path, net: tuple[str, str], step_s: float = 0.1) -> Path:
    """Return a SUMO configuration of a network with a sharp bend, made by netconvert."""
    nodes, edges = net
    built.network(folder, nodes, ROADS + edges)
    configuration = folder / "n.sumocfg"
    configuration.write_text(
        '<configuration><input><net-file value="n.net.xml"/></input>'
        f'<time><step-length value="{step_s}"/></time></configuration>'
    )
    return configuration


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Return what gives the folder of a run of one ego that has left at its route's end."""

    @cache
    def drive(net: tuple[str, str], route: str, controller: str = "vo_mpc", step_s: float = 0.1) -> Path:
        folder = tmp_path_factory.mktemp("bend")
        configuration, out = build(folder, net, step_s), folder / "run"
        asked = RunRequest(
            str(configuration), controller, duration_s=40.0, ego_route=tuple(route.split()), out=out
        )
        result = run(asked)
        assert result.valid, result.invalid_reason
        assert result.description["egos_given_up"] == []
        assert result.description["n_routes_restored"] == 0
        return out

    return drive


@pytest.mark.long
@pytest.mark.parametrize(("net", "route"), [(CORNER, "wj js"), (CORNER, "sj jw"), (FORK, "wj js")])
@pytest.mark.parametrize(("controller", "step_s"), [("vo_mpc", 0.1), ("vo_mpc", 1.0), ("aeb", 0.1)])
def test_an_ego_gets_round_a_sharp_bend_and_sumo_has_it_where_it_is(
    driven: Callable[..., Path], net: tuple[str, str], route: str, controller: str, step_s: float
) -> None:
    egos = pd.read_parquet(driven(net, route, controller, step_s) / "egos.parquet")
    assert not egos["intervention"].any()
    assert egos["intervention_cause"].isna().all()
    assert egos["edge"].iloc[-1] == route.split()[-1]


@pytest.mark.long
def test_a_bend_made_drivable_is_driven_like_one_that_was(driven: Callable[..., Path]) -> None:
    slowest = []
    for route, redrawn in (("wj js", 1), ("sj jw", 0)):
        folder = driven(RIGHT_ANGLE, route)
        path = Route(read_network(folder.parent / "n.net.xml"), route.split(), "passenger").path(0, 0)
        assert len(path.bends) == redrawn
        egos = pd.read_parquet(folder / "egos.parquet")
        fronts = zip(egos["front_x_m"], egos["front_y_m"], egos["heading_rad"], strict=True)
        axles = np.array([rear_axle_of(*front, Body().front) for front in fronts])
        along, across, _ = path.curve.project(axles)
        inside = (along > path.pieces[1].start - 3.0) & (along < path.pieces[1].end + 3.0)
        assert np.abs(across[inside]).max() < 0.5
        slowest.append(egos["speed_mps"][inside].min())
    assert slowest[0] > 0.8 * slowest[1]


@pytest.mark.long
def test_a_run_names_the_bends_that_are_too_tight(driven: Callable[..., Path]) -> None:
    bends = json.loads((driven(CORNER, "wj js", "vo_mpc", 0.1) / "run.json").read_text())["tight_bends"]
    assert list(bends) == [":j_1_0"]
    assert 1.0 < bends[":j_1_0"] < 2.5


@pytest.mark.long
def test_in_a_hairpin_every_intervention_has_the_bend_as_its_cause(driven: Callable[..., Path]) -> None:
    egos = pd.read_parquet(driven(CORNER, "js sj") / "egos.parquet")
    assert egos["intervention"].any()
    assert set(egos["intervention_cause"][egos["intervention"]]) == {"tight_bend"}
    assert egos["edge"].iloc[-1] == "sj"


def test_places_on_the_path_through_a_sharp_bend_are_those_of_the_lanes(tmp_path: Path) -> None:
    build(tmp_path, CORNER)
    network = read_network(tmp_path / "n.net.xml")
    path = Route(network, ["wj", "js"], "passenger").path(0, 0)
    (bend,) = path.bends
    before, inside, behind = path.pieces
    ends = [place for piece in path.pieces for place in (piece.start, piece.end)]
    assert ends == sorted(ends)
    assert bend.start < inside.start < inside.end < bend.end
    for piece, position in ((before, 30.0), (before, 70.0), (behind, 20.0), (behind, 60.0)):
        first, last = piece.lane.shape
        point = first + (last - first) * position / piece.lane.shape_length
        along, across, _ = path.curve.project(point[None, :])
        assert across[0] == pytest.approx(0.0, abs=0.01)
        if piece is before:
            assert along[0] - piece.start == pytest.approx(position, abs=0.02)
        else:
            assert piece.end - along[0] == pytest.approx(piece.lane.shape_length - position, abs=0.02)


def test_a_bend_is_named_after_the_lane_that_bends_and_not_after_another_in_a_junction_before(
    tmp_path: Path,
) -> None:
    nodes = CORNER[0] + '<node id="k" x="-9" y="0" radius="1"/>'
    edges = '<edge id="wk" from="w" to="k"/><edge id="kj" from="k" to="j"/><edge id="js" from="j" to="s"/>'
    built.network(tmp_path, nodes, edges)
    path = Route(read_network(tmp_path / "n.net.xml"), ["wk", "kj", "js"], "passenger").path(0, 0)
    (bend,) = path.bends
    straight, bent = (piece for piece in path.pieces if piece.lane.internal)
    assert bend.start < straight.end, "its way begins in the junction before"
    assert bend.lane == bent.lane.name
