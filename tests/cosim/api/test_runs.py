"""Runs, tables and comparisons through the public names, in SUMO and in this one process."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pandas as pd
import pytest

import cosim
from controllers.interface import Controller, Decision, Manoeuvre, Perception, Plan, constant_command

pytestmark = pytest.mark.sumo
SHORT: dict[str, Any] = {"duration_s": 12.0, "warmup_s": 5.0, "ego_headway_s": 5.0}


class Steady:
    """Drives on and counts its plans."""

    def __init__(self, acceleration_mps2: float = 0.0) -> None:
        self.acceleration = acceleration_mps2
        self.plans = 0

    def decide(self, perception: Perception) -> Decision:
        return Decision(Manoeuvre.KEEP, perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        self.plans += 1
        return Plan(constant_command(self.acceleration, 0.0))


def towards_eight(perception: Perception) -> float:
    return 8.0 - perception.ego.speed


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("api")


@pytest.fixture(scope="module")
def both(folder: Path) -> tuple[cosim.Run, cosim.Run]:
    """Two runs one after the other in one process, as in a notebook."""
    one = cosim.run("midblock_zebra", controller="sumo", out=folder / "sumo", **SHORT)
    two = cosim.run("midblock_zebra", controller=towards_eight, out=folder / "own", **SHORT)
    return one, two


@pytest.mark.long
def test_two_runs_in_a_row_are_valid_and_their_tables_are_frames(both: tuple[cosim.Run, cosim.Run]) -> None:
    for one in both:
        assert one.valid, one.invalid_reason
        assert isinstance(one.egos, pd.DataFrame)
        assert one.egos["ego_id"].nunique() == one.numbers["ego_count"] > 0
        assert {"encounter_id", "min_dist_m"} <= set(one.encounters.columns)
        assert len(one.encounters) == one.numbers["n_encounters"]
        assert "<table>" in one._repr_html_()
    assert both[1].controller == "towards_eight"
    driven = both[1].egos.groupby("ego_id")["speed_mps"].last()
    assert (driven - 8.0).abs().max() < 0.5  # what the function asks for is what is driven


@pytest.mark.long
def test_without_encounters_the_columns_have_their_types_all_the_same(folder: Path) -> None:
    alone = cosim.run(
        "midblock_zebra", controller="sumo", out=folder / "alone", pedestrians_per_hour=0, **SHORT
    )
    assert len(alone.encounters) == 0
    assert alone.encounters["min_dist_m"].dtype == float
    assert len(alone.encounters.nsmallest(1, "min_dist_m")) == 0
    assert alone.encounters["collision"].dtype == bool


@pytest.mark.long
def test_a_function_gives_the_same_bytes_twice(both: tuple[cosim.Run, cosim.Run], folder: Path) -> None:
    again = cosim.run("midblock_zebra", controller=towards_eight, out=folder / "again", **SHORT)
    assert again.description["run_id"] == both[1].description["run_id"]
    for name in ("egos.parquet", "neighbours.parquet", "plans.parquet"):
        assert (again.folder / name).read_bytes() == (both[1].folder / name).read_bytes()


@pytest.mark.long
def test_every_ego_has_an_object_of_its_own(folder: Path) -> None:
    mine = Steady()
    ran = cosim.run("midblock_zebra", controller=mine, out=folder / "object", **SHORT)
    assert ran.valid
    assert ran.controller == "Steady"
    assert mine.plans == 0


@pytest.mark.long
def test_a_class_and_a_module_take_parameters(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran = cosim.run("midblock_zebra", controller=Steady, acceleration_mps2=0.5, out=folder / "class", **SHORT)
    assert ran.description["parameters"]["controller"] == {"acceleration_mps2": 0.5}

    def build(*, acceleration_mps2: float = 0.0) -> Controller:
        return Steady(acceleration_mps2)

    module = ModuleType("steady")
    module.build = build  # type: ignore[attr-defined]  # what a file has
    with pytest.raises(cosim.InputError, match="acceleration_mps2"):
        cosim.run("midblock_zebra", controller=module, acceleration_mps2="fast", **SHORT)


@pytest.mark.long
def test_runs_are_compared_loaded_and_drawn(both: tuple[cosim.Run, cosim.Run]) -> None:
    found = cosim.compare(both, alt="towards_eight")
    assert str(found).startswith("towards_eight against sumo on midblock_zebra, 1 seed")
    assert {"metric", "diff_mean", "verdict"} <= set(found.table.columns)
    assert "<table" in found._repr_html_()
    study = cosim.load(both[0].folder.parent)
    assert isinstance(study, cosim.Study)
    assert {one.folder for one in both} <= {one.folder for one in study}
    loaded = cosim.load(both[0].folder)
    assert isinstance(loaded, cosim.Run)
    picture = loaded.plot("plane")
    assert picture.__dict__["_repr_png_"]()[:4] == b"\x89PNG"
    again = cosim.analyse(loaded, severity_ttc_serious_s=np.float64(1.2))
    assert again.table("runs.csv")["n_encounters"].item() == loaded.numbers["n_encounters"]


@pytest.mark.long
def test_a_batch_takes_a_controller_by_its_file_and_notices_that_it_has_changed(
    folder: Path, tmp_path: Path
) -> None:
    file = tmp_path / "slow.py"
    file.write_text(
        "from controllers.outside.functions import FromFunction\n\n\n"
        "def build():\n    return FromFunction(lambda perception: 4.0 - perception.ego.speed)\n"
    )
    content = {"scenarios": ["midblock_zebra"], "controllers": [str(file)], "seeds": [1], "set": SHORT}
    study = cosim.batch(content, out=folder / "by-file", jobs=1)
    assert study.problems == ()
    (ran,) = study
    assert ran.egos.groupby("ego_id")["speed_mps"].last().min() == pytest.approx(4.0, abs=0.5)
    file.write_text(file.read_text().replace("4.0", "5.0"))
    with pytest.raises(cosim.InputError, match=r"slow\.py has another content"):
        cosim.batch(content, out=folder / "by-file", jobs=1)


@pytest.mark.long
def test_numbers_of_numpy_are_numbers(folder: Path) -> None:
    ran = cosim.run(
        "midblock_zebra",
        controller="sumo",
        seed=np.int64(2),  # type: ignore[arg-type]  # what people pass
        duration_s=np.float64(8.0),
        warmup_s=np.float32(5.0),
        ego_count=np.int64(1),
        out=folder / "numpy",
    )
    assert ran.valid
    assert ran.description["parameters"]["scenario"]["warmup_s"] == 5.0


@pytest.mark.long
def test_a_batch_gives_the_tables_of_a_study(folder: Path) -> None:
    content = {"scenarios": ["midblock_zebra"], "controllers": ["sumo"], "seeds": "1-2", "set": SHORT}
    study = cosim.batch(content, out=folder / "batch", jobs=1)
    assert study.problems == ()
    assert sorted(study.runs["seed"]) == [1, 2]
    assert len(study) == 2
    assert "midblock_zebra" in study._repr_html_()
    assert cosim.batch(content, out=folder / "batch", jobs=1).runs.equals(study.runs)


@pytest.mark.long
@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"controller": 3}, "expected a name, a function of a perception"),
        ({"controller": lambda a, b: 0.0}, "takes 2 arguments"),
        ({"controller": "no_such"}, "no controller 'no_such'"),
        ({"controller": "./no_such.py"}, "there is no such file"),
        ({"controller": lambda perception: "fast"}, "expected a Plan, a Command"),
        ({"controller": lambda perception: float("nan")}, "finite"),
        ({"pedestrians": 3}, "no such parameter"),
        ({"seed": -1}, "--seed: expected a whole number"),
        ({"seed": 1.5}, "seed: expected a whole number, got 1.5"),
        ({"duration_s": "ten"}, "duration_s: expected a number, got 'ten'"),
        ({"ego_share": [0.5]}, "ego_share: expected a number"),
    ],
)
def test_bad_input_is_one_line_before_the_first_step(
    arguments: dict[str, object], told: str, folder: Path
) -> None:
    with pytest.raises(cosim.InputError, match=told) as caught:
        cosim.run("midblock_zebra", out=folder / "bad", **{**SHORT, **arguments})
    assert "\n" not in str(caught.value)
    assert not (folder / "bad").exists()


@pytest.mark.long
def test_what_is_not_there_is_answered_by_what_is(both: tuple[cosim.Run, cosim.Run], tmp_path: Path) -> None:
    with pytest.raises(cosim.InputError, match=r"tables there: .*encounters\.csv"):
        both[0].table("speeds.csv")
    with pytest.raises(cosim.InputError, match="expected one of space-time, plane, traces"):
        both[0].plot("speed")
    with pytest.raises(cosim.InputError, match="no run in it"):
        cosim.load(tmp_path)
    with pytest.raises(cosim.InputError, match="expected runs, a study or a folder"):
        cosim.compare([], alt="sumo")
    with pytest.raises(cosim.InputError, match="severity"):
        cosim.analyse(both[0], severity_ttc_seriuos_s=1.0)


def test_a_file_is_a_controller_for_the_command_line_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slow.py").write_text(
        '"""Drives slowly."""\n\n\ndef build(*, speed_mps: float = 5.0):\n'
        "    from controllers.outside.functions import FromFunction\n\n"
        "    return FromFunction(lambda perception: speed_mps - perception.ego.speed)\n"
    )
    from cosim.cli import main

    words = ["run", "midblock_zebra", "--controller", "./slow.py", "--set", "speed_mps=4"]
    assert (
        main([*words, *(part for key, value in SHORT.items() for part in ("--set", f"{key}={value}"))]) == 0
    )
    (made,) = (tmp_path / "runs").iterdir()
    assert made.name == "midblock_zebra-slow.py-1-1"
    ran = cosim.load(made)
    assert isinstance(ran, cosim.Run)
    assert list(ran.description["controller_files"]) == ["slow.py"]


def test_an_interruption_ends_the_callers_loop_and_keeps_what_was_recorded(tmp_path: Path) -> None:
    def interrupt(now: float, _: float | None) -> None:
        if now > 7.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cosim.run("midblock_zebra", controller="sumo", out=tmp_path / "run", progress=interrupt, **SHORT)
    kept = cosim.load(tmp_path / "run")
    assert isinstance(kept, cosim.Run)
    assert (kept.valid, kept.invalid_reason) == (False, "interrupted")
