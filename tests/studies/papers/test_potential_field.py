"""The numbers of the potential-field paper's experiments."""

from __future__ import annotations

import contextlib
import io
import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from studies.papers.__main__ import main
from studies.papers.claim import Claim, Status
from studies.papers.potential_field import experiments, scenes, spread
from studies.papers.potential_field import figures as drawings
from studies.papers.potential_field.scenes import (
    FIXED_AXIS,
    GRAVITY,
    SAFE,
    SCENES,
    Scene,
    Track,
    planned,
)
from studies.papers.potential_field.spread import gain_grid
from studies.papers.table import read_claims
from tests.studies.papers.holds import HOLDS

PAPER = "003"
SCENE = MappingProxyType({scene.name: scene for scene in SCENES})
RIGHT_ANGLE = math.radians(90.0)


# The experiments and the tests ask for the same drives and counts; each is made once.
driven, directions, orders = cache(scenes.driven), cache(spread.directions), cache(spread.orders)


@dataclass(frozen=True, slots=True)
class Made:
    """What the command makes and prints."""

    folder: Path
    claims: list[Claim]
    shown: str


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Run all experiments once, by the command."""
    folder = tmp_path_factory.mktemp("potential-field") / "out"
    shown = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(shown):
        for name, found in (("driven", driven), ("directions", directions), ("orders", orders)):
            patch.setattr(experiments, name, found)
        assert main([PAPER, "--out", str(folder)]) == 0
    return Made(folder, read_claims(folder / "claims.csv"), shown.getvalue())


@pytest.mark.slow
def test_a_second_run_gives_the_same_claims_and_figures(made: Made, tmp_path: Path) -> None:
    assert experiments.run(tmp_path) == made.claims
    figures = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert figures == {path.name: path.read_bytes() for path in (made.folder / "figures").iterdir()}


@pytest.mark.long
def test_a_drive_and_a_figure_come_out_the_same_again(made: Made, tmp_path: Path) -> None:
    first, again = driven(SCENES[0], "fixed"), scenes.driven(SCENES[0], "fixed")
    assert first is not again
    assert (again.x.tolist(), again.y.tolist()) == (first.x.tolist(), first.y.tolist())
    drawings.draw_directions(tmp_path / "again.png")
    there = made.folder / "figures/003-direction-probabilities.png"
    assert (tmp_path / "again.png").read_bytes() == there.read_bytes()


@pytest.mark.long
def test_the_command_counts_the_claims(made: Made) -> None:
    known, shown = made.claims, made.shown
    assert {claim.paper for claim in known} == {PAPER}
    reproduced = [claim.status for claim in known].count(Status.RESULT)
    (line, *_) = (line for line in shown.splitlines() if line.startswith(f"| {PAPER}"))
    assert str(reproduced) in line
    for claim in known:
        if claim.status is Status.NOT_REPRODUCED:
            assert claim.claim.split()[0] in shown


@pytest.mark.parametrize(("name", "axis"), [("1", 18.779), ("2", 21.975), ("3", 11.841), ("4", 20.900)])
def test_the_long_half_axes_of_the_four_scenes(name: str, axis: float) -> None:
    assert SCENE[name].long_axis == pytest.approx(axis, abs=5e-4)
    assert pytest.approx(1.83) == SAFE


def test_with_one_start_for_all_scenes_their_axes_would_not_be_the_papers() -> None:
    """So the starts differ, whichever they are: the paper has scene 3 alone below 15 m."""
    assert Scene("3", 50.0, 4.0, RIGHT_ANGLE).long_axis == pytest.approx(23.8, abs=0.05)
    axes = [Scene("", 50.0, 3.0, math.radians(angle)).long_axis for angle in (30.0, 90.0, 150.0)]
    assert axes[1] < 15.0 < axes[2]
    assert planned(Scene("2", 50.0, 3.0, math.radians(30.0)), axes[0]).side == "left"


@pytest.mark.parametrize(
    ("name", "fixed", "variable"),
    [
        # largest curvature [1/m], smallest clearance [m], where the avoidance begins [m]
        ("1", (0.00363, 0.82, 22.0), (0.00249, 0.92, 14.7)),
        ("2", (0.00399, 0.40, 25.7), (0.00215, 0.60, 13.5)),
        ("3", (0.00336, 1.11, 25.2), (0.00476, 1.01, 31.7)),
        ("4", (0.00388, 0.54, 21.0), (0.00225, 0.70, 11.2)),
    ],
)
def test_the_planned_paths(
    name: str, fixed: tuple[float, float, float], variable: tuple[float, float, float]
) -> None:
    scene = SCENE[name]
    for axis, (bend, clearance, begins) in ((FIXED_AXIS, fixed), (scene.long_axis, variable)):
        track = planned(scene, axis)
        assert track.highest_curvature == pytest.approx(bend, abs=6e-6)
        assert track.clearance == pytest.approx(clearance, abs=0.0051)
        assert track.begins == pytest.approx(begins, abs=0.051)
        assert track.side == ("left" if name == "3" else "right")
        assert track.beyond_edge < 0.0
        assert track.falls_then_rises()


@pytest.mark.parametrize(("name", "acceleration"), [("1", 0.16), ("2", 0.14), ("3", 0.30), ("4", 0.14)])
def test_the_lateral_accelerations(name: str, acceleration: float) -> None:
    track = planned(SCENE[name], SCENE[name].long_axis)
    assert track.lateral_acceleration / GRAVITY == pytest.approx(acceleration, abs=0.0051)


def test_a_field_that_moves_with_the_pedestrian_bends_the_path_more() -> None:
    scene = Scene("3", 70.0, 4.0, RIGHT_ANGLE)
    fixed, variable = (planned(scene, axis, moving=True) for axis in (FIXED_AXIS, scene.long_axis))
    assert fixed.highest_curvature == pytest.approx(0.00545, abs=6e-6)
    assert variable.highest_curvature == pytest.approx(0.00636, abs=6e-6)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: f"scene {scene.name}")
@pytest.mark.parametrize("axis", ["fixed", "variable"])
def test_the_car_drives_what_was_planned(scene: Scene, axis: str) -> None:
    plan = planned(scene, FIXED_AXIS if axis == "fixed" else scene.long_axis)
    track: Track = driven(scene, axis)
    off = np.abs(track.y - np.interp(track.x, plan.x, plan.y))
    assert off.max() < 0.1
    assert track.clearance == pytest.approx(plan.clearance, abs=0.08)
    assert track.highest_curvature == pytest.approx(plan.highest_curvature, rel=0.15)
    assert track.side == plan.side
    assert track.beyond_edge < 0.0
    # Constant speed: 25 m/s along the path, which is hardly longer than the road.
    assert np.diff(track.x)[-10:] == pytest.approx(2.5, abs=0.01)


@pytest.mark.parametrize(
    ("moving", "curvature", "untouched", "on_road", "everything"),
    [(False, (102, 102, 105, 99), 66, 75, 33), (True, (102, 102, 102, 102), 72, 78, 42)],
)
def test_the_orders_are_generic_and_safety_is_not(
    moving: bool, curvature: tuple[int, ...], untouched: int, on_road: int, everything: int
) -> None:
    assert len(np.asarray(gain_grid().centre)) == 108
    found = orders(moving=moving)
    # A set at its limit may fall on either side where rounding differs.
    assert [int(holds.sum()) for holds in found.curvature.values()] == pytest.approx(curvature, abs=1)
    assert found.begins.all()
    assert found.left.all()
    counts = [int(holds.sum()) for holds in (found.untouched, found.on_road, found.everything)]
    assert counts == pytest.approx([untouched, on_road, everything], abs=1)


def test_the_tuned_field_does_not_avoid_who_walks_in_any_direction() -> None:
    fixed, variable = directions(variable=False), directions(variable=True)
    assert fixed.probabilities.sum() == pytest.approx(1.0)
    assert variable.touched == pytest.approx(0.451, abs=0.005)
    assert fixed.touched == pytest.approx(0.999, abs=0.005)


@pytest.mark.long
def test_every_claim_has_what_the_table_needs(made: Made) -> None:
    found = made.claims
    assert {claim.paper for claim in found} == {"003"}
    for claim in found:
        assert claim.our_value
        assert claim.claim.endswith(".")
        assert claim.why or claim.status in HOLDS
    keys = [(claim.experiment, claim.claim) for claim in found]
    assert len(keys) == len(set(keys))


@pytest.mark.long
def test_what_is_reproduced_what_is_fitted_and_what_is_not(made: Made) -> None:
    by_status = {
        status: {(claim.experiment, claim.claim) for claim in made.claims if claim.status is status}
        for status in Status
    }
    assert not by_status[Status.RESULT]
    assert {experiment for experiment, _ in by_status[Status.ARITHMETIC]} == {"directions"}
    missed = {experiment for experiment, _ in by_status[Status.OWN_CHECK_FAILED]}
    assert not by_status[Status.NOT_REPRODUCED]
    assert missed == {
        "directions, both utilities linear",
        "108 untuned gain sets, field at the conflict point",
        "108 untuned gain sets, field moves",
        "direction drawn from the model, start (50, 4)",
    }
    fitted = [claim for claim in made.claims if claim.status is Status.FITTED]
    assert {f"scene {name}, path" for name in "1234"} <= {claim.experiment for claim in fitted}
    own = {experiment for experiment, _ in by_status[Status.OWN_CHECK]}
    assert {f"scene {name}, driven" for name in "1234"} <= own


@pytest.mark.long
def test_the_figures_are_drawn(made: Made) -> None:
    figures = made.folder / "figures"
    names = {path.name for path in figures.iterdir()}
    assert names == {
        "003-curvature.png",
        "003-direction-probabilities.png",
        "003-distance.png",
        "003-field-and-paths.png",
        "003-outlines.png",
        "003-parts-of-the-field.png",
    }
    assert all((figures / name).stat().st_size > 10_000 for name in names)
