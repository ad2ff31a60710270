"""Real tracks through the whole analysis: onto a network, judged, reported."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.files import read_csv, read_json
from analysis.trajectories.reading import read_trajectories
from analysis.validation.statement import SENTENCE
from cosim.errors import InputError
from cosim.sumo.network_file import read_network
from cosim.tracks.judging import Judged, TracksRequest, judge
from cosim.tracks.lanes import Walkways
from tests.analysis.trajectories import streets
from tests.cosim.cli.commands import ended
from tests.cosim.tracks import networks
from tests.cosim.tracks.pairs import pairs


@pytest.fixture(scope="module")
def network(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return networks.street(tmp_path_factory.mktemp("street"))


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory, network: Path) -> Judged:
    folder = tmp_path_factory.mktemp("judged")
    path = streets.write(folder / "tracks.csv", streets.crowd())
    return judge(TracksRequest(str(path), network, out=folder / "out"))


def test_each_walk_over_the_crossing_before_a_car_is_an_encounter(judged: Judged) -> None:
    rows = read_csv(judged.folder / "traffic_encounters.csv")
    met = {(row["vehicle_id"], row["ped_id"]) for row in rows}
    assert {(f"car {number}", f"walker {number}") for number in range(6)} <= met
    assert {row["controller"] for row in rows} == {"tracks"}
    assert {row["crossing_type"] for row in rows} == {"zebra"}
    assert {row["vehicle_class"] for row in rows} == {"passenger"}


def test_a_pet_worked_out_by_hand(judged: Judged) -> None:
    # The front of car 0 is at x = 22.25 m at the start; the disc's path begins at 99.75 m and ends at 100.25 m,
    # which its rear leaves after (100.25 - 17.75) m / 10 m/s = 8.25 s. The pedestrian enters the car's lane at
    # y = -2.75 m, after 2.0 s + 2.75 m / 1.2 m/s = 4.292 s, and leaves it 0.45 m beyond, at y = -0.45 m: 6.208 s.
    # The car comes at (99.75 - 22.25) m / 10 m/s = 7.75 s: 1.542 s later.
    rows = read_csv(judged.folder / "traffic_encounters.csv")
    (row,) = [row for row in rows if (row["vehicle_id"], row["ped_id"]) == ("car 0", "walker 0")]
    assert float(row["pet_area_s"]) == pytest.approx(1.542, abs=0.02)
    assert row["pet_status"] == "ok"


def test_metrics_of_every_pair_agree_with_an_independent_judge(judged: Judged) -> None:
    traffic = pd.read_parquet(judged.folder / "traffic.parquet")
    rows = read_csv(judged.folder / "traffic_encounters.csv")
    compared = {"distance": 0, "ttc": 0, "pet": 0}
    for pair in pairs(traffic):
        mine = [row for row in rows if (row["vehicle_id"], row["ped_id"]) == (pair.vehicle, pair.pedestrian)]
        assert len(mine) == 1, pair
        assert float(mine[0]["min_dist_m"]) == pytest.approx(pair.distance, abs=0.01)
        compared["distance"] += 1
        if mine[0]["min_ttc_s"]:
            assert float(mine[0]["min_ttc_s"]) == pytest.approx(pair.ttc, abs=0.02)
            compared["ttc"] += 1
        if mine[0]["pet_status"] == "ok":
            assert float(mine[0]["pet_area_s"]) == pytest.approx(pair.pet, abs=0.02)
            compared["pet"] += 1
    assert compared["distance"] >= 5
    assert compared["ttc"] >= 2
    assert compared["pet"] >= 4


def test_the_folder_is_that_of_a_run_and_says_how_well_the_tracks_fit(judged: Judged) -> None:
    description = read_json(judged.folder / "run.json")
    assert (description["valid"], description["controller"], description["n_egos"]) == (True, "tracks", 0)
    fit = {row["class"]: row for row in read_csv(judged.folder / "tracks_fit.csv")}
    assert float(fit["car"]["share_samples"]) == 1.0
    assert float(fit["car"]["median_distance_m"]) == pytest.approx(0.0, abs=0.01)
    assert int(fit["pedestrian"]["n_tracks"]) == 6
    traffic = pd.read_parquet(judged.folder / "traffic.parquet")
    assert set(traffic["phase"].dropna()) == {"walking", "waiting", "crossing"}
    on = traffic[traffic["phase"] == "crossing"]
    assert np.allclose(on["x_m"], 100.0)


def test_the_same_tracks_give_the_same_bytes(tmp_path: Path, judged: Judged, network: Path) -> None:
    path = streets.write(tmp_path / "tracks.csv", streets.crowd())
    again = judge(TracksRequest(str(path), network, out=tmp_path / "again"))
    for name in ("traffic.parquet", "traffic_encounters.csv", "crossings.csv", "map.json", "tracks_fit.csv"):
        assert (again.folder / name).read_bytes() == (judged.folder / name).read_bytes(), name


def test_the_report_of_tracks_lists_and_replays_their_encounters(judged: Judged) -> None:
    done = ended("report", judged.folder)
    assert "0 encounters" not in done.stdout
    page = (judged.folder / "report.html").read_text("utf-8")
    assert "walker 1" in page
    assert list((judged.folder / "report_data" / "replays").glob("*.js"))


def test_the_command_prints_the_fit_and_says_what_is_assumed(tmp_path: Path, network: Path) -> None:
    path = streets.write(tmp_path / "tracks.csv", streets.crowd()[:2])
    done = ended("analyse", path, "--network", network, "--out", tmp_path / "out")
    assert "pedestrian" in done.stdout
    assert "encounters of vehicles and pedestrians" in done.stdout
    assert "lengths and widths of vehicles are assumed" in done.stderr


def test_gaps_make_several_tracks_and_the_clock_is_that_of_the_samples(tmp_path: Path, network: Path) -> None:
    table = streets.car(duration_s=10.0)
    path = streets.write(tmp_path / "t.csv", [table[(table["time_s"] < 3.0) | (table["time_s"] > 5.0)]])
    done = judge(TracksRequest(str(path), network, out=tmp_path / "out"))
    traffic = pd.read_parquet(done.folder / "traffic.parquet")
    assert sorted(set(traffic["object_id"])) == ["car", "car/2"]
    assert read_json(done.folder / "run.json")["step_s"] == 0.1


def test_tracks_in_another_coordinate_system_are_projected(tmp_path: Path) -> None:
    folder = tmp_path / "net"
    folder.mkdir()
    network = networks.street(folder)
    projection = "+proj=tmerc +lat_0=52.0 +lon_0=10.0 +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs"
    text = network.read_text().replace('projParameter="!"', f'projParameter="{projection}"')
    network.write_text(text)
    from pyproj import Transformer

    table = pd.concat(streets.crowd()[:2], ignore_index=True)
    back = Transformer.from_crs(projection, "EPSG:4326", always_xy=True)
    table["lon_deg"], table["lat_deg"] = back.transform(table["x_m"].to_numpy(), table["y_m"].to_numpy())
    path = streets.write(tmp_path / "t.csv", [table.drop(columns=["x_m", "y_m"])])
    done = judge(TracksRequest(str(path), network, out=tmp_path / "out"))
    traffic = pd.read_parquet(done.folder / "traffic.parquet")
    car = traffic[traffic["object_id"] == "car 0"]
    assert car["y_m"].to_numpy() == pytest.approx(-1.6, abs=2e-3)
    assert car["x_m"].iloc[0] == pytest.approx(22.25, abs=2e-3)


def test_a_projection_that_does_not_fit_and_a_network_without_one_are_refused(
    tmp_path: Path, network: Path
) -> None:
    table = streets.car()
    table["y_m"] += 500.0
    path = streets.write(tmp_path / "t.csv", [table])
    with pytest.raises(InputError, match=r"row 2: the projection does not fit: 101 of 101 samples"):
        judge(TracksRequest(str(path), network, out=tmp_path / "out"))
    assert not (tmp_path / "out").exists()
    with pytest.raises(InputError, match="has no projection, so positions in EPSG:32632 have no place on it"):
        judge(TracksRequest(str(path), network, crs="EPSG:32632", out=tmp_path / "out"))
    with pytest.raises(InputError, match="expected assumed or recorded, got 'guessed'"):
        TracksRequest(str(path), network, bodies="guessed")


def test_flags_of_tracks_need_a_network(tmp_path: Path) -> None:
    assert "expected --network" in ended("analyse", tmp_path, "--crs", "EPSG:1", code=2).stderr


@pytest.mark.parametrize("flag", ["--ssam", "--xlsx"])
def test_what_is_written_of_egos_is_refused_for_tracks(flag: str) -> None:
    said = ended("analyse", "t.csv", "--network", "n.net.xml", flag, code=2).stderr
    assert said == f"cosim: {flag} writes the egos of a run, and tracks have none\n"


def test_without_the_extra_the_command_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from cosim.tracks import projection

    monkeypatch.setitem(sys.modules, "pyproj", None)
    table = streets.car().rename(columns={"x_m": "lon_deg", "y_m": "lat_deg"})
    path = streets.write(tmp_path / "t.csv", [table])
    location = projection.Location(tmp_path, (0.0, 0.0), "+proj=tmerc +lat_0=52.0 +lon_0=10.0")
    with pytest.raises(InputError, match="pyproj is not installed; run: pip install"):
        projection.onto_network(read_trajectories(path), location)


def test_pedestrians_may_walk_on_a_road_that_has_no_sidewalk(tmp_path: Path) -> None:
    edges = networks.EDGES.replace('speed="13.89" sidewalkWidth="2"', 'speed="1.5"', 1)
    walkways = Walkways(read_network(networks.street(tmp_path, edges=edges)))
    x = np.array([50.0, 150.0])
    _, away = walkways.nearest(x, np.full(2, -1.6))  # on the eastbound lane: e1 has no sidewalk, e2 has one
    assert away[0] == 0.0
    assert away[1] > 0.4


@pytest.mark.long
def test_a_street_without_crossings_is_judged_and_reported(tmp_path: Path) -> None:
    network = networks.street(tmp_path, crossing="<connections/>")
    path = streets.write(tmp_path / "t.csv", streets.crowd()[:4])
    done = judge(TracksRequest(str(path), network, out=tmp_path / "out"))
    assert done.encounters >= 1
    ended("report", done.folder)
    page = (done.folder / "report.html").read_text("utf-8")
    assert "walker 1" in page
    assert "const EGOS = false" in page
    assert SENTENCE not in page, "it is of simulated traffic"
    assert list((done.folder / "report_data" / "replays").glob("*.js"))
