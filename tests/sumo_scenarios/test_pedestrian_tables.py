"""What ``[[pedestrians]]`` may say, and that everything else is one line with file and row."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as some

from sumo_scenarios.distribution import Distribution, read_distribution
from sumo_scenarios.library import ScenarioError, load, prepare, with_parameters
from sumo_scenarios.pedestrian_tables import LineTable, WalkerTable
from sumo_scenarios.trajectories import read_trajectories

DEFINITION = """
description = "mine"
duration_s = 10.0
[network]
nodes = "n.xml"
edges = "e.xml"
[demand]
routes = ["r.xml"]
vehicles_per_hour = 60.0
[parameters.pace]
default = 1.4
description = "of walking"
[[pedestrians]]
name = "child"
kind = "line"
from_m = [50.0, -5.0]
to_m = [50.0, 5.0]
speed_mps = "$pace"
start = { overlap = 0.25 }
"""


def write(folder: Path, text: str) -> Path:
    (folder / "scenario.toml").write_text(text)
    return folder


def test_parameters_are_filled_in_wherever_they_are_named(tmp_path: Path) -> None:
    scenario = load(str(write(tmp_path, DEFINITION)))
    (child,) = scenario.pedestrians
    assert isinstance(child, LineTable)
    assert child.speed_mps == Distribution("choice", (1.4,))
    changed, _ = with_parameters(scenario, {"pace": "2.5"})
    (faster,) = changed.pedestrians
    assert isinstance(faster, LineTable)
    assert faster.speed_mps.highest == 2.5
    with pytest.raises(ScenarioError, match=r"row 1: key 'speed_mps': expected 0.05 to 12.5, got 99 to 99"):
        with_parameters(scenario, {"pace": "99"})


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('kind = "line"', 'kind = "dancing"', "kind is 'dancing'; expected one of trajectory, line, jaywalk, crossing"),
        ('kind = "line"', "", "kind is None; expected one of"),
        ('name = "child"', 'name = "a child"', "name is 'a child'; expected letters"),
        ('name = "child"', "", "key 'name' is missing"),
        ('"$pace"', '"$speed"', r"names \$speed; parameters that exist: pace, vehicles_per_hour"),
        ('"$pace"', '"fast"', "key 'speed_mps': expected a number, .* got 'fast'"),
        ('"$pace"', "-1.0", "key 'speed_mps': expected 0.05 to 12.5"),
        ('"$pace"', "{ normal = [1.4, 0.3] }", "give a minimum and a maximum"),
        ('"$pace"', "{ normal = [1.4] }", "'normal': expected two numbers, got 1"),
        ('"$pace"', "{ choice = [1.4], weights = [1, 2] }", "'weights': expected 1 numbers, got 2"),
        ("[50.0, 5.0]", "[50.0, -5.0]", "from_m and to_m are the same place"),
        ("[50.0, 5.0]", "[50.0]", "key 'to_m': list should have at least 2 items"),
        ("{ overlap = 0.25 }", "{ overlap = 1.25 }", "key 'start.overlap': expected 0 to 1, got 1.25"),
        ("{ overlap = 0.25 }", "{ }", "start: expected exactly one of time_s, per_hour"),
        ("{ overlap = 0.25 }", "{ overlap = 0.25, time_s = 3.0 }", "got 2"),
        ("{ overlap = 0.25 }", '{ time_s = 1.0, signal = "red" }', "'signal' belongs to kind 'crossing'"),
        ("{ overlap = 0.25 }", "{ overlap = 0.5, accepted_gap_s = 3.0 }", "do not go with 'overlap'"),
        ("{ overlap = 0.25 }", "{ overlap = 0.25 }\nhat = 1", "unknown key 'hat'; keys of this kind: name, kind"),
        (
            "{ overlap = 0.25 }",
            '{ overlap = 0.25 }\nmanners = [{ kind = "hesitating" }]',
            "manner 'hesitating' needs the key 'after_m'",
        ),
        (
            "{ overlap = 0.25 }",
            '{ overlap = 0.25 }\nmanners = [{ kind = "steady", after_m = 1.0 }]',
            "manner 'steady' has no key 'after_m'",
        ),
        (
            "{ overlap = 0.25 }",
            '{ overlap = 0.25 }\nmanners = [{ kind = "turning_back" }]',
            "needs 'after_m' or 'ego_within_s'",
        ),
        ("{ overlap = 0.25 }", "{ overlap = 0.25 }\nmanners = []", "expected at least one of weight above 0"),
    ],
)  # fmt: skip
def test_a_bad_row_names_file_row_and_what_was_expected(
    tmp_path: Path, old: str, new: str, expected: str
) -> None:
    with pytest.raises(ScenarioError, match=expected) as caught:
        load(str(write(tmp_path, DEFINITION.replace(old, new))))
    text = str(caught.value)
    assert text.startswith(f"{tmp_path / 'scenario.toml'}: [[pedestrians]] row 1: ")
    assert "\n" not in text


def test_a_name_is_used_once(tmp_path: Path) -> None:
    twice = DEFINITION + DEFINITION[DEFINITION.index("[[pedestrians]]") :]
    with pytest.raises(ScenarioError, match=r"row 2: there is a row named 'child' already"):
        load(str(write(tmp_path, twice)))


CSV = "time_s,x_m,y_m,person\n0.0,1.0,2.0,A\n0.5,1.0,2.5,A\n0.25,3.0,3.0,B\n0.75,3.0,3.5,B\n"


def test_a_trajectory_file_has_one_track_per_person(tmp_path: Path) -> None:
    path = tmp_path / "recorded.csv"
    path.write_text(CSV)
    found = read_trajectories(path)
    assert found["A"].tolist() == [[0.0, 1.0, 2.0], [0.5, 1.0, 2.5]]
    assert found["B"].shape == (2, 3)
    path.write_text("x_m, y_m, time_s\n1,2,0\n1,3,1\n")
    assert read_trajectories(path)[""].tolist() == [[0.0, 1.0, 2.0], [1.0, 1.0, 3.0]]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("time_s,x_m\n0,1\n", "column 'y_m' is missing; expected time_s, x_m, y_m and perhaps person"),
        ("", "column 'time_s' is missing; .* got nothing"),
        ("time_s,x_m,y_m\n", "has no rows"),
        ("time_s,x_m,y_m\n0,1,1\n", "the person has one row only"),
        ("time_s,x_m,y_m\n0,1,1\n1,one,1\n", "row 3: x_m is 'one'; expected a number"),
        ("time_s,x_m,y_m\n0,1,1\n1,1\n", "row 3: y_m is None; expected a number"),
        ("time_s,x_m,y_m\n0,1,1\n1,inf,1\n", "row 3: x_m is 'inf'; expected a finite number"),
        ("time_s,x_m,y_m\n0,1,1\n1,1,2\n0.5,1,3\n", "row 4: time_s is 0.5, after 1 in the row before of the person"),
        ("time_s,x_m,y_m\n0,1,1\n0,1,2\n", "row 3: time_s is 0, after 0"),
        ("time_s,x_m,y_m\n0,1,1\n1,14,1\n", r"row 3: the person would move at 13.0 m/s; expected at most 12.5 m/s"),
        ("time_s,x_m,y_m,person\n0,1,1,\n", "row 2: column 'person' is empty"),
        (CSV.replace("0.75", "0.1"), "row 5: time_s is 0.1, after 0.25 in the row before of person 'B'"),
    ],
)  # fmt: skip
def test_a_bad_trajectory_names_file_and_row(tmp_path: Path, text: str, expected: str) -> None:
    (tmp_path / "bad.csv").write_text(text)
    row = '[[pedestrians]]\nname = "r"\nkind = "trajectory"\nfile = "bad.csv"\n'
    start = DEFINITION[: DEFINITION.index("[[pedestrians]]")]
    with pytest.raises(ScenarioError, match=expected) as caught:
        load(str(write(tmp_path, start + row)))
    assert str(caught.value).startswith(str(tmp_path / "bad.csv"))
    assert "\n" not in str(caught.value)


def test_a_trajectory_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    row = '[[pedestrians]]\nname = "r"\nkind = "trajectory"\nfile = "gone.csv"\n'
    with pytest.raises(ScenarioError, match=r"gone.csv: cannot be read: No such file"):
        load(str(write(tmp_path, DEFINITION[: DEFINITION.index("[[pedestrians]]")] + row)))


def test_what_is_said_of_pedestrians_is_part_of_a_runs_identity_but_no_path_is(tmp_path: Path) -> None:
    inputs = []
    for name, pace in (("a", "1.4"), ("b", "1.4"), ("c", "1.5")):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "n.xml").write_text('<nodes><node id="a" x="0" y="0"/><node id="b" x="100" y="0"/></nodes>')
        (folder / "e.xml").write_text('<edges><edge id="ab" from="a" to="b"/></edges>')
        (folder / "r.xml").write_text("<routes/>")
        (folder / "recorded.csv").write_text(CSV)
        row = '[[pedestrians]]\nname = "r"\nkind = "trajectory"\nfile = "recorded.csv"\n'
        scenario, _ = with_parameters(load(str(write(folder, DEFINITION + row))), {"pace": pace})
        inputs.append(prepare(scenario, 1, folder / "work").inputs)
    assert inputs[0] == inputs[1]
    assert inputs[0]["pedestrians"] != inputs[2]["pedestrians"]
    assert inputs[0]["r: recorded.csv"] == inputs[2]["r: recorded.csv"]


@given(
    mean=some.floats(-5.0, 5.0),
    deviation=some.floats(0.01, 3.0),
    low=some.floats(-3.0, 0.0),
    width=some.floats(0.5, 6.0),
)
def test_a_cut_distribution_stays_within_its_bounds(
    mean: float, deviation: float, low: float, width: float
) -> None:
    assume(low - 3.0 * deviation < mean < low + width + 3.0 * deviation)
    found = read_distribution({"normal": [mean, deviation], "minimum": low, "maximum": low + width})
    drawn = np.array([found.draw(np.random.default_rng(seed)) for seed in range(20)])
    assert drawn.min() >= low
    assert drawn.max() <= low + width


@pytest.mark.parametrize(
    ("value", "mean", "deviation"),
    [
        ({"normal": [3.0, 0.5]}, 3.0, 0.5),
        ({"uniform": [1.0, 3.0]}, 2.0, 2.0 / np.sqrt(12.0)),
        ({"lognormal": [2.0, 0.25]}, 2.0 * np.exp(0.25**2 / 2), 0.524),
        ({"choice": [1.0, 5.0], "weights": [3.0, 1.0]}, 2.0, np.sqrt(3.0)),
        (4, 4.0, 0.0),
    ],
)
def test_drawn_numbers_have_the_moments_that_they_ought_to(
    value: object, mean: float, deviation: float
) -> None:
    generator = np.random.default_rng(11)
    found = read_distribution(value)
    drawn = np.array([found.draw(generator) for _ in range(20000)])
    # Four standard errors of 20,000 draws.
    assert drawn.mean() == pytest.approx(mean, abs=4.0 * max(deviation, 1e-9) / np.sqrt(20000))
    assert drawn.std() == pytest.approx(deviation, abs=0.03 * max(deviation, 1e-9))


def test_the_built_in_scenarios_describe_walkers() -> None:
    for name in ("jaywalk_arterial", "bus_stop_occlusion"):
        tables = load(name).pedestrians
        assert tables
        assert all(isinstance(table, WalkerTable) for table in tables)
