"""Readers of trajectories: every layout, and what each refuses."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.errors import RecordingError
from analysis.trajectories import dlr
from analysis.trajectories.reading import read_trajectories
from tests.analysis.trajectories import streets


def message(path: Path | str) -> str:
    with pytest.raises(RecordingError) as error:
        read_trajectories(path)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_a_plain_table_gets_speeds_and_headings_from_its_positions(tmp_path: Path) -> None:
    found = read_trajectories(streets.write(tmp_path / "t.csv", [streets.car(), streets.walker()])).frame
    car, walker = (found[found["id"] == name] for name in ("car", "walker"))
    assert car["speed_mps"].to_numpy() == pytest.approx(10.0)
    assert car["heading_rad"].to_numpy() == pytest.approx(0.0)
    assert walker["heading_rad"].to_numpy() == pytest.approx(0.5 * np.pi)
    assert set(found["kind"]) == {"car", "pedestrian"}


def test_units_in_the_names_of_columns_are_converted(tmp_path: Path) -> None:
    table = streets.car()
    table["speed_kmh"], table["heading_deg"], table["x_ft"] = 36.0, 0.0, table["x_m"] / 0.3048
    table["y_ft"] = table["y_m"] / 0.3048
    path = streets.write(tmp_path / "t.csv", [table.drop(columns=["x_m", "y_m"])])
    found = read_trajectories(path).frame
    assert found["speed_mps"].to_numpy() == pytest.approx(10.0)
    assert found["x_m"].to_numpy() == pytest.approx(streets.car()["x_m"].to_numpy())


def test_who_stands_keeps_the_heading_of_before(tmp_path: Path) -> None:
    moving = streets.track("a", "car", (0.0, 0.0), (0.0, 5.0), 0.0, 2.0)
    standing = streets.track("a", "car", (0.0, 10.0), (0.0, 0.0), 2.1, 2.0)
    found = read_trajectories(streets.write(tmp_path / "t.csv", [moving, standing])).frame
    assert found["heading_rad"].to_numpy() == pytest.approx(0.5 * np.pi)
    assert found["speed_mps"].iloc[-1] == 0.0


def dlr_table(samples: int = 40) -> pd.DataFrame:
    time = pd.Timestamp("2023-09-24 12:00:00.016+00:00") + pd.to_timedelta(0.05 * np.arange(samples), "s")
    table = pd.DataFrame({"timestamp": time.astype(str), "id": 1695556712692966})
    table["center_easting"], table["center_northing"] = 604755.0 + 0.25 * np.arange(samples), 5792823.0
    for name in ("velocity_northing", "acceleration_easting", "acceleration_northing"):
        table[name] = 0.0
    table["velocity_easting"] = table["velocity_magnitude"] = 5.0
    table["acceleration_magnitude"] = table["yaw"] = 0.0
    table["dimension_length"], table["dimension_width"], table["dimension_height"] = 3.1, 1.5, 1.4
    for name in ("pedestrian", "bicycle", "motorbike", "van", "truck"):
        table[f"classifications_{name}"] = 0.05
    table["classifications_car"] = np.where(np.arange(samples) < samples / 4, 0.0, 0.8)
    return table


def test_the_class_of_a_dlr_track_is_the_likeliest_on_average_and_an_archive_is_read(tmp_path: Path) -> None:
    path = tmp_path / "archive.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("data/raw_data/trajectories/t.csv", dlr_table().to_csv(index=False))
        archive.writestr("data/raw_data/weather/w.csv", "a\n1\n")
    found = read_trajectories(path)
    assert (found.crs, found.bodies_known) == (dlr.CRS, False)
    assert set(found.frame["kind"]) == {"car"}
    assert found.frame["time_s"].iloc[0] == pytest.approx(0.016)
    assert found.frame["id"].iloc[0] == "1695556712692966"


def write_levelxd(folder: Path, kind: str = "car") -> Path:
    frames = np.arange(50)
    tracks = pd.DataFrame({"recordingId": 7, "trackId": 3, "frame": frames, "trackLifetime": frames})
    tracks["xCenter"], tracks["yCenter"] = 0.4 * frames, 2.0
    tracks["heading"], tracks["width"], tracks["length"] = 360.0, 1.9, 4.6
    tracks["xVelocity"], tracks["yVelocity"] = 10.0, 0.0
    tracks.to_csv(folder / "07_tracks.csv", index=False)
    pd.DataFrame({"trackId": [3], "class": [kind]}).to_csv(folder / "07_tracksMeta.csv", index=False)
    meta = {"frameRate": [25.0], "xUtmOrigin": [293487.0], "yUtmOrigin": [5629711.0], "lonLocation": [6.06]}
    pd.DataFrame(meta).to_csv(folder / "07_recordingMeta.csv", index=False)
    return folder / "07_tracks.csv"


def test_the_layout_of_ind_is_read_with_its_meta_data(tmp_path: Path) -> None:
    found = read_trajectories(write_levelxd(tmp_path, "truck_bus"))
    assert found.crs == "EPSG:32632"
    assert found.frame["x_m"].iloc[1] == pytest.approx(293487.4)
    assert found.frame["time_s"].iloc[-1] == pytest.approx(49 / 25)
    assert found.frame["heading_rad"].to_numpy() == pytest.approx(0.0, abs=1e-9)
    assert (found.frame["kind"].iloc[0], found.frame["length_m"].iloc[0]) == ("truck", 4.6)


def test_the_layout_of_ind_without_its_meta_data_is_refused(tmp_path: Path) -> None:
    path = write_levelxd(tmp_path)
    (tmp_path / "07_recordingMeta.csv").unlink()
    assert "07_recordingMeta.csv: no such file" in message(path)
    write_levelxd(tmp_path, "dragon")
    assert "row 2: unknown class 'dragon'" in message(path)


FCD = """<fcd-export>
 <timestep time="0.00"><vehicle id="a" x="10" y="0" angle="90" type="veh_bicycle" speed="5"/></timestep>
 <timestep time="0.10"><vehicle id="a" x="10.5" y="0" angle="90" type="veh_bicycle" speed="5"/>
  <person id="a" x="3" y="4" angle="0" speed="1.4"/></timestep>
 <timestep time="0.20"><vehicle id="a" x="11" y="0" angle="90" type="veh_bicycle" speed="SPEED"/></timestep>
</fcd-export>"""


def test_floating_car_data_has_front_bumpers_and_degrees_from_north(tmp_path: Path) -> None:
    path = tmp_path / "fcd.xml"
    path.write_text(FCD.replace("SPEED", "5"))
    found = read_trajectories(path)
    assert found.at_front
    assert dict(found.frame.groupby("id")["kind"].first()) == {"a": "bicycle", "person a": "pedestrian"}
    vehicle = found.frame[found.frame["id"] == "a"]
    assert vehicle["heading_rad"].to_numpy() == pytest.approx(0.0)
    path.write_text(FCD.replace("SPEED", "fast"))
    assert "speed of <vehicle>: expected a number, got 'fast'" in message(path)
    path.write_text("<routes/>")
    assert "the root element is <routes>; expected <fcd-export>" in message(path)


def test_times_of_floating_car_data_may_be_those_of_a_clock(tmp_path: Path) -> None:
    path = tmp_path / "fcd.xml"
    text = FCD.replace("SPEED", "5")
    path.write_text(text.replace('time="0.', 'time="1:07:00:00.'))
    times = read_trajectories(path).frame["time_s"].unique()
    assert times == pytest.approx([111600.0, 111600.1, 111600.2])  # a day and seven hours
    path.write_text(text.replace('time="0.1', 'time="7:0x:1'))
    assert "time of <timestep>: expected seconds or h:m:s, got '7:0x:10'" in message(path)


TABLE = """timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_type;vehicle_speed;vehicle_lane
0.00;a;10.00;0.00;90.00;veh_bicycle;5.00;in_0
0.10;a;10.50;0.00;90.00;veh_bicycle;5.00;in_0
0.10;a;3.00;4.00;0.00;DEFAULT_PEDTYPE;1.40;
0.20;a;11.00;0.00;90.00;veh_bicycle;5.00;in_0
"""


def test_floating_car_data_as_a_table_is_what_it_is_as_xml(tmp_path: Path) -> None:
    xml, table, parquet = (tmp_path / name for name in ("fcd.xml", "fcd.csv", "fcd.parquet"))
    xml.write_text(FCD.replace("SPEED", "5"))
    table.write_text(TABLE)
    pd.read_csv(table, sep=";").to_parquet(parquet)
    expected = read_trajectories(xml)
    for path in (table, parquet):
        found = read_trajectories(path)
        assert found.at_front
        assert not found.bodies_known
        pd.testing.assert_frame_equal(found.frame.drop(columns="row"), expected.frame.drop(columns="row"))
    table.write_text(TABLE.replace("vehicle_lane", "vehicle_pos"))
    assert "row 1: no column 'vehicle_lane' (SUMO's floating car data)" in message(table)
    parquet.write_bytes(parquet.read_bytes()[:200])
    assert "not a readable Parquet file" in message(parquet)


def changed(tmp_path: Path, **columns: Any) -> Path:
    table = streets.car()
    for name, value in columns.items():
        table[name] = value
    return streets.write(tmp_path / "bad.csv", [table])


def test_missing_columns_are_named_with_those_that_exist(tmp_path: Path) -> None:
    path = streets.write(tmp_path / "bad.csv", [streets.car().drop(columns=["time_s", "class"])])
    assert "row 1: no column 'class', 'time_s'" in message(path)
    assert "there are id, x_m, y_m" in message(path)


def test_a_road_user_without_an_id_is_refused_with_its_row(tmp_path: Path) -> None:
    table = streets.car()
    table.loc[5, "id"] = None
    assert "row 7: id: expected a name, found none" in message(streets.write(tmp_path / "bad.csv", [table]))


def test_time_that_runs_backwards_is_refused_with_its_row(tmp_path: Path) -> None:
    table = streets.car()
    table.loc[5, "time_s"] = 0.1
    assert "row 7: time of 'car' runs backwards from 0.4 s to 0.1 s" in message(
        streets.write(tmp_path / "bad.csv", [table])
    )


def test_an_id_that_two_road_users_have_is_refused_with_its_row(tmp_path: Path) -> None:
    both = pd.concat([streets.car(), streets.car()]).sort_values("time_s", kind="stable")
    assert "row 3: 'car' has a second sample at 0 s" in message(streets.write(tmp_path / "bad.csv", [both]))


def test_tracks_that_jump_are_refused_with_their_row(tmp_path: Path) -> None:
    table = streets.car()
    table.loc[50:, "x_m"] += 40.0
    assert "row 52: 'car' jumps 41.0 m in 0.1 s" in message(streets.write(tmp_path / "bad.csv", [table]))


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"speed_mps": 36.0}, "speeds look like km/h"),
        ({"speed_mps": 22.37}, "speeds look like mph"),
        ({"speed_mps": 32.81}, "speeds look like ft/s"),
        ({"speed_mps": 10.0 * 0.3048}, "positions are not in the same unit as the speeds (feet?)"),
        ({"heading_rad": 90.0}, "row 2: heading 90 is no angle in radians"),
        ({"x_m": "far"}, "row 2: x_m: expected a number, got 'far'"),
        ({"x_m": np.nan}, "row 2: x_m: expected a number, found none"),
        ({"class": "dog"}, "row 2: unknown class 'dog'; expected one of pedestrian"),
        ({"speed_kmh": 1.0, "speed_mps": 1.0}, "columns speed_mps and speed_kmh exclude each other"),
        ({"x_m": 10.5361 + 1e-6 * np.arange(101), "y_m": 52.2755, "speed_mps": 5.0}, "look like degrees"),
    ],
)
def test_wrong_units_and_cells_are_refused_with_their_row(
    tmp_path: Path, columns: dict[str, object], said: str
) -> None:
    assert said in message(changed(tmp_path, **columns))


def test_mixed_units_of_positions_are_refused(tmp_path: Path) -> None:
    table = streets.car().rename(columns={"y_m": "y_ft"})
    assert "mixed units x_m and y_ft" in message(streets.write(tmp_path / "bad.csv", [table]))


def test_an_empty_or_absent_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty.csv").write_text("id,class,time_s,x_m,y_m\n")
    assert "no rows" in message(tmp_path / "empty.csv")
    assert "No such file" in message(tmp_path / "absent.csv")


def test_a_package_that_is_not_installed_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dlr, "PACKAGED", "no-such-package-here")
    assert "not installed" in message("no-such-package-here")
