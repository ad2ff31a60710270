"""What may be varied, and every mistake in it."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from cosim.errors import InputError
from cosim.search.scenario_file import scenario_text
from cosim.search.space import filled, read_space, read_space_file
from cosim.search.subject import read_subject
from sumo_scenarios import library
from sumo_scenarios.pedestrian_tables import TrajectoryTable

SPEED = {"minimum": 0.5, "maximum": 2.5}


def space(**parameters: Any) -> dict[str, Any]:
    return {"parameters": parameters}


def test_a_parameter_is_an_axis_with_a_distribution() -> None:
    found = read_space(
        space(
            speed_mps={**SPEED, "distribution": {"normal": [1.5, 0.25]}},
            size={"minimum": 1.0, "maximum": 3.0, "whole": True},
            side={"choices": ["left", "right"], "weights": [3.0, 1.0]},
        ),
        "test",
    )
    speed, size, side = found.parameters
    assert (speed.axis.low, speed.axis.high) == (0.5, 2.5)
    assert speed.quantile(0.5) == 1.5
    assert [size.quantile(share) for share in (0.0, 0.3, 0.5, 1.0)] == [1, 1, 2, 3]
    assert [side.quantile(share) for share in (0.74, 0.76)] == ["left", "right"]


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (space(speed_mps={}), "parameters.speed_mps: has no range; expected 'minimum' and 'maximum'"),
        (space(speed_mps={"minimum": 2.0, "maximum": 2.0}), "expected minimum < maximum, got 2 and 2"),
        (space(Speed=SPEED), "expected small letters, digits and '_'"),
        (space(speed_mps={**SPEED, "choices": ["a"]}), "expected either 'choices' or a range"),
        (space(speed_mps={**SPEED, "unit": "m"}), "unknown key 'parameters.speed_mps.unit'"),
        ({**space(speed_mps=SPEED), "seed": "any"}, "key 'seed': input should be 'fixed'"),
        *(
            (
                space(**{name: SPEED}),
                f"parameters.{name}: the name is taken; expected none of clearance_min_m",
            )
            for name in ("margin", "seed", "kind", "happening", "min_ttc_s", "status")
        ),
        ({**space(route=SPEED), "where": {}}, "parameters.route: the name is taken"),
        ({}, "nothing to vary; expected at least one of"),
        (
            space(speed_mps={**SPEED, "distribution": {"normal": [9.0, 0.001]}}),
            "distribution: 'normal': nothing lies between 0.5 and 2.5",
        ),
        (
            space(pause_s={**SPEED, "when": {"manner": ["running"]}}),
            "when.manner: expected some of its choices",
        ),
    ],
)
def test_a_mistake_is_one_line_that_says_what_was_expected(content: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=re.escape(told)) as error:
        read_space(content, "test")
    assert "\n" not in str(error.value)


def test_names_are_replaced_at_any_depth_and_unknown_ones_refused() -> None:
    table = {"start": {"ego_arrival_s": "$gap_s"}, "list": ["$gap_s", 2.0]}
    assert filled(table, {"gap_s": 3.0}, "test") == {"start": {"ego_arrival_s": 3.0}, "list": [3.0, 2.0]}
    with pytest.raises(InputError, match=r"names \$gab_s; did you mean"):
        filled("$gab_s", {"gap_s": 3.0}, "test")


def test_a_parameter_that_changes_nothing_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "space.toml"
    file.write_text("[parameters.walking_mps]\nminimum = 1.0\nmaximum = 2.0\n")
    with pytest.raises(InputError, match=r"parameters.walking_mps changes nothing; expected \$walking_mps"):
        read_subject("jaywalk_arterial", "aeb", {}, file)


def test_a_criterion_that_is_none_is_refused_as_cosim_check_does(tmp_path: Path) -> None:
    file = tmp_path / "criteria.toml"
    for text in ("criteria = [1]", 'title = "x"\n[[criteria]]\n'):
        file.write_text(text)
        with pytest.raises(InputError, match=re.escape(f"--criteria {file}: only [[criteria]] expected")):
            read_subject("jaywalk_arterial", "aeb", {}, None, file)


def test_a_trial_names_a_trajectory_of_the_space_from_where_it_is_itself(tmp_path: Path) -> None:
    row = '[[search.pedestrians]]\nname = "a"\nkind = "trajectory"\nfile = "$walk"\n'
    text = f'{row}[search.parameters.walk]\nchoices = ["slow.csv", "fast.csv"]\n'
    shutil.copytree(library.LIBRARY / "jaywalk_arterial", tmp_path / "mine")
    definition = tmp_path / "mine" / library.DEFINITION
    content = definition.read_text().replace("../road_users", str(library.LIBRARY / "road_users"))
    definition.write_text(content[: content.index("[search]")] + text)
    (tmp_path / "space").mkdir()
    (tmp_path / "space" / "space.toml").write_text(text)
    for folder, file in ((tmp_path / "mine", None), (tmp_path / "space", tmp_path / "space" / "space.toml")):
        (folder / "fast.csv").write_text("time_s,x_m,y_m\n0,100,0\n5,100,7\n")
        scenario = str(tmp_path / "mine") if file is None else "jaywalk_arterial"
        subject = read_subject(scenario, "aeb", {}, file)
        trial = tmp_path / "out" / "trial"
        trial.mkdir(parents=True, exist_ok=True)
        (trial / library.DEFINITION).write_text(scenario_text(subject, {"walk": "fast.csv"}, trial, "x"))
        (one,) = library.load(str(trial)).pedestrians
        assert isinstance(one, TrajectoryTable)
        assert Path(one.file).resolve() == folder / "fast.csv"


def test_a_file_that_is_no_toml_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "space.toml"
    file.write_text("[parameters")
    with pytest.raises(InputError, match="not valid TOML"):
        read_space_file(file)


@pytest.mark.parametrize(
    "name",
    [name for name in library.names() if (table := library.load(name).table) is not None and table.search],
)
def test_the_space_of_a_built_in_scenario_is_whole_and_says_where_it_is_from(name: str) -> None:
    subject = read_subject(name, "aeb", {})
    assert len(subject.space.parameters) >= 3
    for one in subject.space.parameters:
        assert one.description, one.axis.name
        assert one.source, one.axis.name
        assert one.axis.value(0.5) == one.axis.value(one.axis.share(one.axis.value(0.5)))
