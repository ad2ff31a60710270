"""The street simulated again and compared, from the command line."""

from __future__ import annotations

import shutil
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from analysis.files import read_csv, read_json
from cosim.errors import InputError
from cosim.validation.calibrate import CalibrationRequest, calibrated, types_of
from cosim.validation.site import read_site
from cosim.validation.span import span_of
from cosim.validation.types_file import read_types, types_of_classes, types_text
from cosim.validation.validate import ValidationRequest, planned
from tests.analysis.trajectories import streets
from tests.cosim.cli.commands import ended
from tests.cosim.tracks import networks


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with street.sumocfg and tracks.csv of ten cars and ten pedestrians."""
    folder = tmp_path_factory.mktemp("site")
    networks.street(folder)
    networks.configure(folder)
    streets.write(folder / "tracks.csv", streets.rush())
    return folder


@pytest.fixture(scope="module")
def validation(folder: Path) -> Path:
    out = folder / "validation"
    done = ended(
        *("validate", folder / "street.sumocfg", "--tracks", folder / "tracks.csv"),
        *("--seeds", "1-2", "--jobs", "1", "--out", out),
    )
    assert "walking_speed" in done.stdout
    assert "simulated again: 10 car, 10 pedestrian" in done.stdout
    return out


@pytest.mark.long
@pytest.mark.sumo
def test_who_departed_when_and_where_is_simulated_again(validation: Path) -> None:
    routes = ElementTree.parse(validation / "scenario" / "rebuilt.rou.xml").getroot()
    trip = next(iter(routes.iter("trip")))
    assert (trip.get("from"), trip.get("to"), trip.get("departLane")) == ("e1", "e2", "1")
    assert float(trip.get("departPos", "")) == pytest.approx(22.25, abs=0.3)
    walk = next(iter(routes.iter("walk")))
    assert {walk.get("from"), walk.get("to")} <= {"e1", "e2", "w1", "w2"}
    record = read_json(validation / "validation.json")
    assert record["departed"] == {"car": 10, "pedestrian": 10}
    assert record["left_out"] == {}
    runs = sorted((validation / "simulated").rglob("traffic.parquet"))
    assert len(runs) == 2
    assert pd.read_parquet(runs[0])["object_id"].nunique() == 20


@pytest.mark.long
@pytest.mark.sumo
def test_real_road_users_are_counted_once_and_simulated_ones_in_every_run(validation: Path) -> None:
    rows = {row["quantity"]: row for row in read_csv(validation / "validation.csv")}
    speed = rows["walking_speed"]
    assert (speed["n_real"], speed["n_simulated"]) == ("10", "20")
    assert float(speed["real_mean"]) == pytest.approx(1.45, abs=0.01)
    assert float(speed["difference_lo"]) < float(speed["difference"]) < float(speed["difference_hi"])
    assert rows["bicycle_speed"]["verdict"] == "too few"
    assert rows["car_speed"]["verdict"] in ("different", "indistinguishable")


@pytest.mark.long
@pytest.mark.sumo
def test_a_validation_is_resumed_and_gives_the_same_bytes(validation: Path, folder: Path) -> None:
    before = (validation / "validation.csv").read_bytes()
    # Only finished runs are compared, and not what a failed one has left behind, for instance.
    (one, *_) = (validation / "simulated" / "runs").iterdir()
    shutil.copytree(one, validation / "simulated" / "elsewhere" / "run")
    done = ended(
        *("validate", folder / "street.sumocfg", "--tracks", folder / "tracks.csv"),
        *("--seeds", "1-2", "--jobs", "1", "--out", validation),
    )
    assert "2 of 2 runs finished" in done.stdout
    assert (validation / "validation.csv").read_bytes() == before


@pytest.mark.sumo
def test_a_calibration_writes_types_that_a_validation_takes(folder: Path, tmp_path: Path) -> None:
    done = calibrated(
        CalibrationRequest(
            str(folder / "street.sumocfg"), str(folder / "tracks.csv"), split_s=100.0, out=tmp_path / "c"
        )
    )
    assert done.estimates["walking_speed"].n == 5
    types = read_types(done.file)
    assert float(types["pedestrian"]["desiredMaxSpeed"]) == pytest.approx(1.2, abs=0.01)
    assert "n = 5" in done.file.read_text()
    assert "car" not in types or "tau" not in types["car"], "nobody follows anybody here"
    rows = {row["parameter"]: row for row in read_csv(tmp_path / "c" / "estimates.csv")}
    assert rows["critical_gap"]["value"] == ""
    assert "pedestrians chose among gaps" in rows["critical_gap"]["method"]
    assert types_of({**done.estimates})[0] == types


def test_the_folder_of_another_validation_is_refused_and_stays_as_it_was(tmp_path: Path) -> None:
    def site(name: str, speed: float, *options: str) -> Path:
        folder = tmp_path / name
        folder.mkdir()
        networks.street(folder, *options)
        streets.write(folder / "tracks.csv", [streets.car("a", speed, duration_s=9.0), streets.walker()])
        return networks.configure(folder)

    street = site("one", 10.0)
    out = tmp_path / "out"

    def request(tracks: str = "one", **more: Any) -> ValidationRequest:
        values: dict[str, Any] = {"scenario": str(street), "seeds": "1", "out": out, **more}
        return ValidationRequest(tracks=str(tmp_path / tracks / "tracks.csv"), **values)

    def content() -> dict[Path, bytes]:
        return {path: path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()}

    planned(request())
    before = content()
    other = site("other", 9.0, "--default.lanewidth", "3.3")
    types = tmp_path / "types.toml"
    types.write_text(types_text({"car": {"tau": "2.0"}}, {}))
    for another, what in (
        (request("other"), "tracks"),
        (request(scenario=str(other)), "network"),
        (request(types=types), "types"),
        (request(span_s=(0.0, 5.0)), "span"),
        (request(span_s=(0.0, 5.0), types=types), "types and span"),
    ):
        with pytest.raises(InputError, match=f"the validation in it has another {what}; expected the same"):
            planned(another)
        assert content() == before
    with pytest.raises(InputError, match=r"absent/tracks\.csv: cannot be read"):
        planned(request("absent"))
    planned(request())


def test_bad_requests_are_refused_in_one_line(tmp_path: Path, folder: Path) -> None:
    street, tracks = folder / "street.sumocfg", folder / "tracks.csv"
    out = ("--out", tmp_path / "out")
    assert "no such scenario" in ended("validate", "nowhere", "--tracks", tracks, *out, code=2).stderr
    said = ended("validate", street, "--tracks", "absent.csv", *out, code=2).stderr
    assert "absent.csv: cannot be read" in said
    said = ended("validate", street, "--tracks", tracks, "--from", "90", "--to", "20", *out, code=2).stderr
    assert "expected a part of the recording" in said
    for command in ("validate", "calibrate"):
        said = ended(command, street, "--tracks", tracks, "--seeds", "1 to 5", *out, code=2).stderr
        assert f'cosim {command}: seeds = "1 to 5"' in said
        said = ended(command, "midblock_zebra", "--tracks", "absent.csv", *out, code=2).stderr
        assert "absent.csv: cannot be read" in said
        assert not (tmp_path / "out").exists()  # so that the mended command finds its folder free
    said = ended("calibrate", street, "--tracks", tracks, "--split", "9000", *out, code=2).stderr
    assert "expected a second within the recording" in said


def test_types_are_read_as_they_were_written_and_wrong_ones_refused(tmp_path: Path) -> None:
    types = {"car": {"tau": "1.1", "speedFactor": "normc(1,0.1,0.5,1.5)"}}
    path = tmp_path / "types.toml"
    path.write_text(types_text(types, {"car.tau": "time_gap 1.1 s"}))
    assert read_types(path) == types
    path.write_text('[types.cra]\ntau = "1"\n')
    with pytest.raises(InputError, match="unknown class 'cra'; did you mean 'car'"):
        read_types(path)
    path.write_text("tau = 1\n")
    with pytest.raises(InputError, match=r"expected tables \[types.car\]"):
        read_types(path)
    assert span_of(None, None) is None


def variant_with_types(folder: Path, types: str) -> Path:
    """Write a variant of the street whose configuration has types, which the variant replaces."""
    networks.street(folder)
    networks.configure(folder)
    configuration = (folder / "street.sumocfg").read_text()
    (folder / "street.sumocfg").write_text(
        configuration.replace("</input>", '<additional-files value="t.add.xml"/></input>')
    )
    (folder / "t.add.xml").write_text(
        '<additional><vType id="slow" decel="9"/><vType id="other"/></additional>'
    )
    (folder / "own.add.xml").write_text(f"<additional>{types}</additional>")
    (folder / "scenario.toml").write_text(
        'description = "a"\nduration_s = 10.0\nstep_s = 0.1\nsumocfg = "street.sumocfg"\n'
        'types = "own.add.xml"\n'
    )
    streets.write(folder / "tracks.csv", streets.rush())
    return folder


@pytest.mark.long
def test_the_types_of_a_variant_are_those_of_the_simulated_road_users(tmp_path: Path) -> None:
    folder = variant_with_types(tmp_path, '<vType id="slow" vClass="passenger" decel="1.662" tau="0.905"/>')
    assert read_site(str(folder), tmp_path / "work").types == {"car": {"decel": "1.662", "tau": "0.905"}}

    def simulated(out: str, types: Path | None) -> tuple[dict[str, str], object]:
        request = ValidationRequest(
            str(folder), str(folder / "tracks.csv"), "1", tmp_path / out, types=types, span_s=(0.0, 30.0)
        )
        planned(request)
        root = ElementTree.parse(tmp_path / out / "scenario" / "rebuilt.rou.xml").getroot()
        (car,) = (one for one in root.iter("vType") if one.get("id") == "recorded_car")
        return dict(car.items()), read_json(tmp_path / out / "validation.json")["types_of_scenario"]

    assert simulated("own", None) == (
        {"id": "recorded_car", "vClass": "passenger", "decel": "1.662", "tau": "0.905"},
        ["car"],
    )
    given = tmp_path / "given.toml"
    given.write_text(types_text({"car": {"tau": "2.0"}}, {}))
    assert simulated("given", given) == (
        {"id": "recorded_car", "vClass": "passenger", "tau": "2.0"},
        [],
    )


def test_two_types_of_a_class_in_a_variant_are_refused_in_one_line(tmp_path: Path) -> None:
    folder = variant_with_types(tmp_path, '<vType id="slow" decel="1"/><vType id="other" decel="2"/>')
    with pytest.raises(InputError, match=r"own.add.xml: several types of class passenger; expected one"):
        read_site(str(folder), tmp_path / "work")
    assert types_of_classes(None) == {}
