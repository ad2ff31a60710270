"""Encounters taken to other tools: judged by the ASAM schema, by other readers, and by the recording itself."""

from __future__ import annotations

import importlib.util
import math
import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from lxml import etree

import cosim
import sumo_scenarios
from cosim.cli import main
from cosim.errors import InputError
from cosim.exchange.network import network_of
from cosim.tracks.judging import TracksRequest, judge
from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.library import load, prepare
from sumo_scenarios.sumo_installation import netconvert, sumo_home
from sumo_scenarios.trajectories import read_trajectories
from tests.analysis.trajectories import streets
from tests.cosim.tracks import networks

pytestmark = pytest.mark.sumo


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> cosim.Run:
    folder = tmp_path_factory.mktemp("exchange") / "run"
    return cosim.run(
        "midblock_zebra",
        controller="aeb",
        out=folder,
        duration_s=30.0,
        warmup_s=20.0,
        ego_headway_s=3.0,
        ego_count=2,
    )


@pytest.fixture(scope="module")
def number(run: cosim.Run) -> int:
    return int(run.encounters.nsmallest(1, "min_dist_m")["encounter_id"].item())


@pytest.fixture(scope="module")
def exported(run: cosim.Run, number: int) -> Path:
    out = run.folder.parent / "exported"
    assert main(["export", str(run.folder), "--encounter", str(number), "--out", str(out)]) == 0
    return out / f"encounter-{number}.xosc"


@cache
def asam_schema() -> etree.XMLSchema:
    found = importlib.util.find_spec("qc_openscenario")
    assert found is not None
    assert found.submodule_search_locations
    return etree.XMLSchema(
        etree.parse(Path(found.submodule_search_locations[0]) / "schema/1.2.0/OpenSCENARIO.xsd")
    )


@pytest.mark.long
def test_the_file_is_valid_by_the_schema_of_asam(exported: Path) -> None:
    schema = asam_schema()
    tree = etree.parse(exported)
    assert schema.validate(tree), schema.error_log
    tree.getroot().remove(tree.getroot().find("Entities"))
    assert not schema.validate(tree)  # the schema can refuse


@pytest.mark.long
def test_the_pedestrian_is_read_back_where_they_were_recorded(
    run: cosim.Run, number: int, exported: Path
) -> None:
    row = run.encounters.set_index("encounter_id").loc[number]
    walked = read_trajectories(exported)[f"pedestrian {row['ped_id']}"]
    people = run.neighbours[(run.neighbours["object_id"] == row["ped_id"])]
    people = people[people["object_kind"] == "pedestrian"]
    begin = row["t_start_s"]
    recorded = people[(people["time_s"] >= begin - 1e-6) & (people["time_s"] <= row["t_end_s"] + 1e-6)]
    assert len(walked) == len(recorded) > 10
    np.testing.assert_allclose(walked[:, 0], recorded["time_s"] - begin, atol=2e-3)
    np.testing.assert_allclose(walked[:, 1:], recorded[["x_m", "y_m"]], atol=1e-3)


@pytest.mark.long
def test_the_egos_rear_axle_is_where_it_was(run: cosim.Run, number: int, exported: Path) -> None:
    row = run.encounters.set_index("encounter_id").loc[number]
    root = ElementTree.parse(exported).getroot()
    (group,) = (one for one in root.iter("ManeuverGroup") if one.get("name") == f"group of {row['ego_id']}")
    vertex = next(group.iter("Vertex"))
    place = vertex.find("Position/WorldPosition")
    assert place is not None
    ego = run.egos[run.egos["ego_id"] == row["ego_id"]]
    time = row["t_start_s"] + float(vertex.get("time") or "nan")
    now = ego.iloc[(ego["time_s"] - time).abs().argmin()]
    # Front bumper to rear axle of a car of 4.5 m: 3.55 m.
    x = now["front_x_m"] - 3.55 * math.cos(now["heading_rad"])
    y = now["front_y_m"] - 3.55 * math.sin(now["heading_rad"])
    assert (float(place.get("x") or 0), float(place.get("y") or 0)) == pytest.approx((x, y), abs=2e-3)


@pytest.mark.long
def test_another_reader_understands_it(exported: Path) -> None:
    from scenariogeneration import xosc  # it takes long to load, and every worker collects this file

    scenario = xosc.ParseOpenScenario(str(exported))
    assert isinstance(scenario, xosc.Scenario)
    names = {one.name for one in scenario.entities.scenario_objects}
    assert any(name.startswith("pedestrian ") for name in names)
    assert any(name.startswith("ego_") for name in names)


@pytest.mark.long
def test_the_road_is_read_back_by_sumo_in_the_same_place(exported: Path, tmp_path: Path) -> None:
    back = tmp_path / "back.net.xml"
    subprocess.run(
        [
            *(netconvert(), "--opendrive-files", exported.with_suffix(".xodr"), "-o", back),
            *("--offset.disable-normalization", "true"),
        ],
        env={**os.environ, "SUMO_HOME": str(sumo_home())},
        capture_output=True,
        check=True,
    )
    root = ElementTree.parse(back).getroot()
    shapes = [str(one.get("shape")) for one in root.iter("lane") if not str(one.get("id")).startswith(":")]
    points = np.array([[float(v) for v in point.split(",")[:2]] for text in shapes for point in text.split()])
    assert points[:, 0].min() == pytest.approx(0.0, abs=15.0)
    assert points[:, 0].max() == pytest.approx(1300.0, abs=15.0)
    assert np.abs(points[:, 1]).max() < 20.0


@pytest.mark.long
def test_another_ego_near_by_is_exported_as_a_vehicle(run: cosim.Run, tmp_path: Path) -> None:
    egos = pd.read_parquet(run.folder / "egos.parquet")

    def apart(encounter: pd.Series) -> float:
        there = egos[egos["time_s"].between(encounter["t_start_s"], encounter["t_end_s"])]
        own, other = (one.set_index("time_s") for _, one in there.groupby("ego_id", observed=True))
        x, y = (other[name] - own[name] for name in ("front_x_m", "front_y_m"))
        return float(np.hypot(x, y).min())

    distances = [apart(encounter) for _, encounter in run.encounters.iterrows()]
    assert min(distances) < 70.0
    nearest = run.encounters.iloc[int(np.argmin(distances))]
    number = str(nearest["encounter_id"])
    assert main(["export", str(run.folder), "--encounter", number, "--out", str(tmp_path / "out")]) == 0
    file = tmp_path / "out" / f"encounter-{number}.xosc"
    named = {str(entity.get("name")) for entity in ElementTree.parse(file).iter("ScenarioObject")}
    (other,) = set(egos["ego_id"]) - {nearest["ego_id"]}
    assert {nearest["ego_id"], f"vehicle {other}"} <= named


def test_the_same_encounter_gives_the_same_bytes(run: cosim.Run, number: int, exported: Path) -> None:
    out = run.folder.parent / "again"
    assert main(["export", str(run.folder), "--encounter", str(number), "--out", str(out)]) == 0
    for path in (exported, exported.with_suffix(".xodr")):
        assert (out / path.name).read_bytes() == path.read_bytes()


@pytest.mark.long
def test_an_exported_pedestrian_walks_in_a_scenario(exported: Path, tmp_path: Path) -> None:
    """They walk in another run as they did in the first one."""
    folder = tmp_path / "midblock_copy"
    source = Path(sumo_scenarios.__file__).parent / "midblock_zebra"
    shutil.copytree(source, folder)
    shutil.copytree(source.parent / "road_users", tmp_path / "road_users")
    shutil.copy(exported, folder / "walk.xosc")
    walks = read_trajectories(exported)
    # An ego that keeps 13.9 m/s comes by: others are not recorded.
    way = min(walks.values(), key=lambda one: float(one[0, 1]))
    start = max(0.0, (way[0, 1] - 40.0) / 13.9)
    with (folder / "scenario.toml").open("a") as file:
        file.write('\n[[pedestrians]]\nname = "imported"\nkind = "trajectory"\nfile = "walk.xosc"\n')
        file.write(f"start_s = {start:.1f}\n")
    ran = cosim.run(
        folder, controller="constant_speed", out=tmp_path / "run", duration_s=start + 7.0, warmup_s=2.0
    )
    assert ran.valid, ran.invalid_reason
    seen = ran.neighbours[ran.neighbours["object_id"].str.startswith("imported")]
    assert len(seen) > 0
    one = seen.iloc[len(seen) // 2]
    time = one["time_s"] - 2.0 - round(start, 1)
    places = [[np.interp(time, way[:, 0], way[:, axis]) for axis in (1, 2)] for way in walks.values()]
    assert min(math.dist(place, (one["x_m"], one["y_m"])) for place in places) < 0.01


@pytest.mark.long
def test_floating_car_data_have_everybody_of_the_recording(run: cosim.Run, tmp_path: Path) -> None:
    assert main(["export", str(run.folder), "--format", "fcd", "--out", str(tmp_path / "fcd")]) == 0
    root = ElementTree.parse(tmp_path / "fcd/fcd.xml").getroot()
    rows = [(step.get("time"), one) for step in root for one in step]
    assert len(rows) == len(run.egos) + len(run.neighbours)
    ego = run.egos.iloc[-1]
    (found,) = (
        one for time, one in rows if one.get("id") == ego["ego_id"] and time == f"{ego['time_s']:.2f}"
    )
    assert float(found.get("x") or 0) == pytest.approx(ego["front_x_m"], abs=1e-3)
    assert float(found.get("angle") or 0) == pytest.approx(90.0 - math.degrees(ego["heading_rad"]), abs=0.01)


@pytest.mark.long
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--encounter", "999"], "no encounter 999"),
        ([], "expected the encounter"),
        (["--encounter", "1", "--format", "commonroad"], "expected openscenario or fcd"),
        (["--encounter", "1", "--network", "no.net.xml"], "there is no such network"),
    ],
)
def test_wrong_use_is_one_line(
    words: list[str], told: str, run: cosim.Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["export", str(run.folder), "--out", str(tmp_path / "out"), *words]) == 2
    said = capsys.readouterr().err
    assert told in said
    assert said.count("\n") == 1


@pytest.mark.long
def test_what_is_no_run_and_a_missing_extra_are_one_line(
    run: cosim.Run, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["export", str(tmp_path), "--encounter", "1", "--out", str(tmp_path / "out")]) == 2
    assert "cannot be read as a run" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "scenariogeneration", None)
    assert main(["export", str(run.folder), "--encounter", "1", "--out", str(tmp_path / "out")]) == 2
    assert "pip install scenariogeneration" in capsys.readouterr().err


@pytest.mark.long
def test_without_a_road_there_is_one_file(run: cosim.Run, number: int, tmp_path: Path) -> None:
    words = ["--encounter", str(number), "--no-road", "--out", str(tmp_path / "out")]
    assert main(["export", str(run.folder), *words]) == 0
    assert [one.suffix for one in (tmp_path / "out").iterdir()] == [".xosc"]


def test_the_network_of_a_protocol_s_case_is_found_by_itself(tmp_path: Path) -> None:
    scenario = load("suite:fmvss127/obstructed_child_30kmh")
    prepared = prepare(scenario, 1, tmp_path)
    description = {"scenario_id": scenario.name, "seed": 1, "inputs": prepared.inputs}
    assert network_of(description) == prepared.net_file
    with pytest.raises(InputError, match=r"is not known .*name the network with --network"):
        network_of({**description, "scenario_id": "town.a"})


def test_an_encounter_of_real_tracks_is_exported(tmp_path: Path) -> None:
    network = networks.street(tmp_path)
    tracks = streets.write(tmp_path / "tracks.csv", streets.crowd())
    judged = judge(TracksRequest(str(tracks), network, out=tmp_path / "judged"))
    rows = pd.read_csv(judged.folder / "traffic_encounters.csv")
    (row,) = rows[(rows["vehicle_id"] == "car 0") & (rows["ped_id"] == "walker 0")].itertuples()
    words = ["--encounter", str(row.traffic_encounter_id), "--traffic", "--network", str(network)]
    assert main(["export", str(judged.folder), *words, "--out", str(tmp_path / "out")]) == 0
    (file,) = (tmp_path / "out").glob("*.xosc")
    assert asam_schema().validate(etree.parse(file))
    assert "pedestrian walker 0" in read_trajectories(file)
    names = [str(one.get("name")) for one in ElementTree.parse(file).getroot().iter("ScenarioObject")]
    assert names[0] == "car 0"
    assert len(names) == len(set(names))


@pytest.mark.long
@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ("<OpenSCENARIO", "<Other", "expected an OpenSCENARIO file|not well-formed"),
        ("FollowTrajectoryAction", "OtherAction", "no pedestrian follows a trajectory"),
        ("WorldPosition", "LanePosition", "without a WorldPosition"),
        ("TimeReference", "NoReference", "has no times"),
        ('<Timing domainAbsoluteRelative="absolute" scale="1.0"', "<Timing", "scale of a Timing"),
    ],
)
def test_a_file_that_is_described_otherwise_is_one_line(
    before: str, after: str, told: str, exported: Path, tmp_path: Path
) -> None:
    wrong = tmp_path / "wrong.xosc"
    text = exported.read_text("utf-8")
    assert before in text
    wrong.write_text(text.replace(before, after), "utf-8")
    with pytest.raises(ScenarioError, match=told) as caught:
        read_trajectories(wrong)
    assert "\n" not in str(caught.value)
