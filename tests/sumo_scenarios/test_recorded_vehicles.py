"""Recorded vehicles from a CSV file, and what is wrong with one in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.recorded_vehicles import read_recorded_vehicles

HEADER = "vehicle,class,edge,time_s,x_m,y_m,heading_rad,speed_mps,length_m,width_m\n"
FIRST = "a,passenger,e1,0.0,1,2,0.5,3,4.5,1.8\n"


def test_each_vehicle_has_its_rows_in_the_order_of_time(tmp_path: Path) -> None:
    path = tmp_path / "vehicles.csv"
    # A spreadsheet begins a file with a byte-order mark.
    path.write_text(
        "\ufeff" + HEADER + FIRST + "b,bus,e2,0.0,9,9,0,0,12,2.5\na, passenger ,e1,0.5,2,3,0.6,4,4.5,1.8\n",
        encoding="utf-8",
    )
    found = read_recorded_vehicles(path)
    assert list(found) == ["a", "b"]
    one = found["a"]
    assert (one.vehicle_class, one.edge, one.length, one.width) == ("passenger", "e1", 4.5, 1.8)
    np.testing.assert_array_equal(one.motion, [[0.0, 1.0, 2.0, 0.5, 3.0], [0.5, 2.0, 3.0, 0.6, 4.0]])
    assert found["b"].vehicle_class == "bus"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "column 'vehicle' is missing; expected vehicle, class, edge, time_s, .* got nothing"),
        (
            HEADER.replace(",edge", "") + FIRST,
            "column 'edge' is missing; expected .*, got vehicle, class, time_s",
        ),
        (HEADER + FIRST.replace("0.5", "north"), "row 2: heading_rad is 'north'; expected a number"),
        (HEADER + FIRST.replace("0.5", "inf"), "row 2: heading_rad is 'inf'; expected a finite number"),
        (HEADER + FIRST + FIRST, "row 3: time_s of 'a' is 0, expected time to go on"),
        (HEADER + "a,passenger\n", "row 2: time_s is None; expected a number"),
    ],
)
def test_what_is_wrong_is_told_with_file_and_row(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "vehicles.csv"
    path.write_text(text)
    with pytest.raises(ScenarioError, match=expected) as caught:
        read_recorded_vehicles(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_or_no_text_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="cannot be read"):
        read_recorded_vehicles(tmp_path / "nothing.csv")
    (tmp_path / "picture.csv").write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(ScenarioError, match="no CSV file"):
        read_recorded_vehicles(tmp_path / "picture.csv")
