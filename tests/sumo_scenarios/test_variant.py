"""A scenario with a base has its roads and demand, and its own values."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from sumo_scenarios import library
from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.pedestrian_tables import TrajectoryTable

TEXT = """description = "one passage"
base = "jaywalk_arterial"
duration_s = 40.0
warmup_s = 10.0
values = { vehicles_per_hour = 200.0, accepted_gap_s = 2.5 }

[egos]
count = 1
routes = [{ edges = "east" }]

[[pedestrians]]
name = "met"
kind = "jaywalk"
edge = "east"
section_m = [200.0, 200.0]
speed_mps = 1.4
start = { ego_arrival_s = "$accepted_gap_s" }
"""
NETWORK = """description = "a network of plain sources"
duration_s = 9.0
[network]
nodes = "a.nod.xml"
edges = "a.edg.xml"
[demand]
routes = ["a.rou.xml"]
"""


def write(folder: Path, text: str = TEXT) -> str:
    folder.mkdir(exist_ok=True)
    (folder / "scenario.toml").write_text(text)
    return str(folder)


def test_a_condition_on_a_parameter_that_the_base_lacks_is_refused(tmp_path: Path) -> None:
    text = TEXT.replace('{ edges = "east" }', '{ edges = "east", when = { nonsense = "x" } }')
    with pytest.raises(ScenarioError, match=r"egos\.routes\.when names 'nonsense'; parameters that exist: "):
        library.load(write(tmp_path / "variant", text))


def test_it_has_its_own_values_and_everything_else_of_its_base(tmp_path: Path) -> None:
    found = library.load(write(tmp_path / "mine"))
    base = library.load("jaywalk_arterial")
    assert (found.name, found.duration_s, found.warmup_s) == ("mine", 40.0, 10.0)
    assert (found.vehicles_per_hour, found.pedestrians_per_hour) == (200.0, base.pedestrians_per_hour)
    assert found.parameters["accepted_gap_s"] == 2.5
    assert found.parameters["goal_along_m"] == base.parameters["goal_along_m"]
    assert (found.egos.count, found.egos.routes) == (1, (("east",),))
    assert [one.name for one in found.pedestrians] == ["met"]
    assert found.table is not None
    assert base.table is not None
    assert found.table.criteria == base.table.criteria
    assert (found.folder, found.variant) == (base.folder, tmp_path / "mine")


def test_a_base_may_be_a_folder_relative_to_the_variant(tmp_path: Path) -> None:
    source = library.LIBRARY / "jaywalk_arterial"
    target = tmp_path / "jaywalk_copy"
    target.mkdir()
    for file in source.iterdir():
        (target / file.name).write_text(
            file.read_text().replace("../road_users", str(source.parent / "road_users"))
        )
    found = library.load(write(tmp_path / "mine", TEXT.replace('"jaywalk_arterial"', '"../jaywalk_copy"')))
    assert found.folder == target.resolve()


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("jaywalk_arterial", "jaywalk", "base 'jaywalk': no such scenario; expected one of"),
        ("accepted_gap_s = 2.5", "gap = 2.5", "values.gap: jaywalk_arterial has no such parameter; it has"),
        ("accepted_gap_s = 2.5", "accepted_gap_s = -1.0", "accepted_gap_s=-1.0: expected at least 0"),
        ("[egos]", "[demand]\nroutes = []\n[egos]", "'demand' does not go with 'base'"),
        ("[egos]", "[search]\nduration_s = 9.0\n[egos]", "'search' does not go with 'base'"),
        (
            "[egos]",
            'types = "t.add.xml"\n[egos]',
            "'types' belongs to a configuration; the types of jaywalk_art",
        ),
        ("warmup_s = 10.0", "warmup_s = 50.0", "warmup_s=50: expected less than duration_s=40"),
    ],
)
def test_what_does_not_fit_is_told_in_one_line(tmp_path: Path, old: str, new: str, told: str) -> None:
    with pytest.raises(ScenarioError, match=told):
        library.load(write(tmp_path / "mine", TEXT.replace(old, new)))


def test_values_belong_to_a_base(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="'values' belongs to 'base'"):
        library.load(
            write(
                tmp_path / "mine",
                'description = "x"\nsumocfg = "a.sumocfg"\nduration_s = 9.0\nvalues = { a = 1 }\n',
            )
        )


RECORDED = """description = "somebody recorded"
base = "jaywalk_arterial"
duration_s = 90.0

[[pedestrians]]
name = "recorded"
kind = "trajectory"
file = "walk.csv"
"""
WALK = "time_s,x_m,y_m\n0,100,0\n5,100,7\n"


def test_a_trajectory_is_in_the_folder_of_whose_scripted_pedestrians_they_are(tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    write(mine, RECORDED)
    with pytest.raises(ScenarioError, match=re.escape(f"{mine / 'walk.csv'}: cannot be read")):
        library.load(str(mine))
    (mine / "walk.csv").write_text(WALK)
    (one,) = library.load(str(mine)).pedestrians
    assert isinstance(one, TrajectoryTable)
    assert one.file == str(mine / "walk.csv")
    base = tmp_path / "base"
    write(base, NETWORK + RECORDED[RECORDED.index("[[ped") :])
    (base / "walk.csv").write_text(WALK)
    other = write(tmp_path / "other", 'description = "x"\nbase = "../base"\nduration_s = 9.0\n')
    (one,) = library.load(other).pedestrians
    assert isinstance(one, TrajectoryTable)
    assert one.file == str(base / "walk.csv")


def test_a_row_that_does_not_fit_is_told_with_the_file_that_has_it(tmp_path: Path) -> None:
    place = Path(write(tmp_path / "mine", RECORDED.replace("walk.csv", "$walk"))) / "scenario.toml"
    with pytest.raises(
        ScenarioError, match=re.escape(f"{place}: [[pedestrians]] row 1: names $walk")
    ) as told:
        library.load(str(place))
    assert str(told.value).startswith(f"{place}: [[")


def test_a_base_has_no_base_itself(tmp_path: Path) -> None:
    write(tmp_path / "one")
    with pytest.raises(ScenarioError, match="has a base itself"):
        library.load(write(tmp_path / "two", TEXT.replace('"jaywalk_arterial"', '"../one"')))


@pytest.mark.parametrize(
    ("first", "then", "resolution"),
    [("hybrid", "move", None), ("move", "hybrid", 0.4), ("hybrid", "hybrid", 0.8)],
)
def test_another_actuation_brings_its_lane_change_model(
    tmp_path: Path, first: str, then: str, resolution: float | None
) -> None:
    base = tmp_path / "base"
    own = "lateral_resolution_m = 0.8\n" if resolution == 0.8 else ""
    write(base, NETWORK.replace("[network]", f'actuation = "{first}"\n{own}[network]'))
    mine = f'description = "x"\nbase = "../base"\nduration_s = 9.0\nactuation = "{then}"\n'
    found = library.load(write(tmp_path / "mine", mine))
    assert (found.actuation, found.lateral_resolution_m) == (then, resolution)
    same, _ = library.with_parameters(library.load(str(base)), {"actuation": then})
    assert same.lateral_resolution_m == resolution
    said = library.load(write(tmp_path / "said", mine + "lateral_resolution_m = 0.2\n"))
    assert said.lateral_resolution_m == 0.2
