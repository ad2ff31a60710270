"""What crossings.csv and crossings.geojson say."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.screening.crossings_table import value_column
from analysis.screening.geojson import features
from analysis.screening.reasons import reasons

USUAL = {
    "speed": 10.0,
    "vehicles": 300.0,
    "pedestrians": 100.0,
    "yields": 0.8,
    "late": 0.1,
    "red": 0.0,
    "hidden": 0.05,
    "length": 7.0,
}


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("speed", 16.0, "fast vehicles (85th percentile 58 km/h, median of all 36)"),
        ("vehicles", 600.0, "many vehicles (600 an hour, median of all 300)"),
        ("yields", 0.1, "drivers rarely yield (10%, median of all 80%)"),
        ("late", 0.5, "pedestrians enter close before vehicles (50%, median of all 10%)"),
        ("red", 0.4, "pedestrians walk on red (40%)"),
        ("hidden", 0.5, "sight obstructed by vehicles (50% of conflicts, median of all 5%)"),
        ("length", 14.0, "long crossing (14 m, median of all 7)"),
        ("yields", float("nan"), ""),
    ],
)
def test_what_is_unusual_is_said(name: str, value: float, told: str) -> None:
    values = {key: np.full(5, usual) for key, usual in USUAL.items()}
    values[name][3] = value
    assert reasons(values, range(5)) == ["", "", "", told, ""]


def test_a_network_without_a_projection_has_no_geojson() -> None:
    row = {"crossing_id": ":a_c0", "rank": 1.0, "longitude_deg": 10.5, "latitude_deg": 52.3}
    found = features([row])
    assert found is not None
    assert found["features"][0]["geometry"] == {"type": "Point", "coordinates": [10.5, 52.3]}
    assert found["features"][0]["properties"]["rank"] == 1.0
    assert features([row, {"crossing_id": ":b_c0"}]) is None


def test_the_column_that_ranks_follow_is_the_conflicts_where_no_speed_is_known() -> None:
    rows = [
        {"ranked_by": "risk", "risk_per_1000_ped": risk, "expected_conflicts_per_1000_ped": 2.0}
        for risk in (None, 0.4)
    ]
    assert value_column(rows) == "risk_per_1000_ped"
    assert value_column(rows[:1]) == "expected_conflicts_per_1000_ped"
    assert (
        value_column([row | {"ranked_by": "conflicts"} for row in rows]) == "expected_conflicts_per_1000_ped"
    )
    assert value_column([]) == "expected_conflicts_per_1000_ped"
