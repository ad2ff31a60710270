"""Where, by whom and what class of contact, on constructed cases whose answer is known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from analysis.results.analyse import RunReport, analyse_run
from tests.analysis.recorded import Ego, Motion, Person, Vehicle, line, write_run

LANE = {
    "name": "road_1",
    "kind": "lane",
    "crossing_kind": "",
    "width_m": 3.2,
    "shape_m": [[-200.0, 0.0], [200.0, 0.0]],
}
SIDEWALK = {**LANE, "name": "road_0", "width_m": 2.0, "shape_m": [[-200.0, -2.6], [200.0, -2.6]]}
CROSSING = {
    "name": ":j_c0",
    "kind": "crossing",
    "crossing_kind": "zebra",
    "width_m": 4.0,
    "shape_m": [[0.0, -1.6], [0.0, 1.6]],
}
WALKING_AREA = {
    "name": ":j_w0",
    "kind": "walkingarea",
    "crossing_kind": "",
    "width_m": 0.0,
    "shape_m": [[-3.0, -1.0], [3.0, -1.0], [3.0, -4.0], [-3.0, -4.0], [-3.0, -1.0]],
}
MAP = (LANE, SIDEWALK, CROSSING, WALKING_AREA)


def report(folder: Path, ego: Ego, person: Person, *vehicles: Vehicle, **keys: Any) -> RunReport:
    ego.columns["lane"] = lambda t: "road_1"
    keys = {"step": 0.05, "duration": 12.0, "areas": MAP, **keys}
    return analyse_run(write_run(folder, [ego], [person], vehicles, **keys))


def only(folder: Path, ego: Ego, person: Person, *vehicles: Vehicle, **keys: Any) -> dict[str, Any]:
    (row,) = report(folder, ego, person, *vehicles, **keys).encounters
    return dict(row)


def walker(motion: Motion, **keys: Any) -> Person:
    return Person(motion, **{"crossing": None, "phase": lambda t: "walking", **keys})


def stands(t: float) -> tuple[float, float]:
    return (min(10.0 * t, 50.0) - 50.0, 0.0)


def test_one_who_is_struck_while_they_stand_did_not_move(tmp_path: Path) -> None:
    row = only(tmp_path, Ego(line(-100, 0, 10, 0)), walker(line(-20, 0.3, 0, 0)))
    assert row["contact_moved_by"] == "ego"
    assert row["contact_class"] == "ego"
    assert row["contact_place"] == "carriageway"
    # The disc is 77.5 m before the bumper at the beginning and visible from then on.
    assert row["contact_risk_seen_s"] == pytest.approx(row["t_collision_s"], abs=0.01)


def test_one_who_crosses_in_front_did_not_close_the_gap(tmp_path: Path) -> None:
    # In the middle of the lane when the bumper at x = −2.25 m comes, at t = 9.75 s.
    row = only(tmp_path, Ego(line(-100, 0, 10, 0)), walker(lambda t: (0.0, 1.3 * (t - 9.75))))
    assert row["impact_side"] == "front"
    assert row["contact_moved_by"] == "ego"


def test_one_who_walks_into_the_side_of_a_moving_car_moved_into_it(tmp_path: Path) -> None:
    row = only(tmp_path, Ego(line(-100, 0, 10, 0)), walker(lambda t: (-20.0, -1.15 + 1.3 * (t - 8.0))))
    assert row["impact_side"] == "right"
    assert row["contact_moved_by"] == "pedestrian"
    assert row["contact_class"] == "ego"


def test_two_who_run_into_each_other_both_moved(tmp_path: Path) -> None:
    row = only(tmp_path, Ego(line(-100, 0, 4, 0)), walker(line(-50, 0.3, -2.0, 0)))
    assert row["contact_moved_by"] == "both"


def test_one_who_walks_into_a_car_that_has_stood_for_a_second_walked_in(tmp_path: Path) -> None:
    # The car stands from 5 s on; the pedestrian touches its side at 6 s.
    person = walker(lambda t: (0.0, min(-1.15 + 1.3 * (t - 6.0), 0.0)))
    found = report(tmp_path, Ego(stands), person)
    (row,) = found.encounters
    assert row["contact_class"] == "walked_in"
    assert row["contact_moved_by"] == "pedestrian"
    assert row["contact_standing"] is True
    assert row["collision"] is False
    assert (found.run["n_collisions"], found.run["n_contacts_standing"]) == (0, 1)


def test_one_against_whom_the_car_rolls_off_did_not_walk_in(tmp_path: Path) -> None:
    def rolls(t: float) -> tuple[float, float]:
        x, y = stands(t)
        return x + 0.5 * max(t - 6.5, 0.0) ** 2, y

    person = walker(lambda t: (0.0, min(-1.15 + 1.3 * (t - 6.0), -1.0)))
    found = report(tmp_path, Ego(rolls), person)
    (row,) = found.encounters
    assert row["contact_class"] == "rolled_off"
    assert row["contact_moved_by"] == "pedestrian"
    assert row["collision"] is True
    assert row["preventable_r157"] is True
    assert found.run["n_collisions_class_rolled_off"] == 1


@pytest.mark.parametrize(("distance", "kind"), [(8.0, "appeared"), (26.0, "appeared"), (29.0, "ego")])
def test_one_first_recorded_inside_the_stopping_distance_appeared(
    tmp_path: Path, distance: float, kind: str
) -> None:
    # At 50 km/h 27.2 m are needed.
    speed = 50 / 3.6
    person = walker(line(-100 + 4.0 * speed + 2.25 + distance + 0.25, 0.2, 0, 0), start=4.0)
    found = report(tmp_path, Ego(line(-100, 0, speed, 0)), person)
    (row,) = found.encounters
    assert row["collision"] is True
    assert row["contact_class"] == kind
    assert row["preventable_r157"] is (kind == "ego")
    assert found.run["n_collisions_class_appeared"] == (kind == "appeared")
    assert found.run["n_collisions"] == 1, "it stays in the total"


def test_one_who_comes_out_of_hiding_did_not_appear(tmp_path: Path) -> None:
    speed = 50 / 3.6
    out = -100 + 4.0 * speed + 2.25 + 8.0
    lorry = Vehicle(line(out - 6.0, -2.8, 0, 0), "lorry", length=10.0, width=2.5)
    person = walker(lambda t: (out, min(-3.2 + 4.0 * (t - 4.0), 0.2)), start=4.0)
    row = only(tmp_path, Ego(line(-100, 0, speed, 0)), person, lorry)
    assert row["collision"] is True
    assert row["preventable_r157"] is False
    assert row["contact_class"] == "ego"


def test_one_inside_the_ego_from_the_first_sample_on(tmp_path: Path) -> None:
    row = only(tmp_path, Ego(line(-100, 0, 10, 0)), walker(line(-70, 0, 0, 0), start=3.0))
    assert row["contact_class"] == "touching_at_start"
    assert row["contact_moved_by"] is None
    assert row["preventable_r157"] is False


@pytest.mark.parametrize(
    ("x", "y", "phase", "place"),
    [
        (1.0, 0.5, "walking", "crossing"),
        (0.0, -1.1, "walking", "crossing"),  # the crossing's end lies on the walking area
        (2.5, -1.1, "walking", "walking_area_or_kerb"),
        (2.5, -0.9, "walking", "carriageway"),
        (-30.0, 1.0, "walking", "carriageway"),
        (-30.0, -1.1, "waiting", "carriageway"),
        (-30.0, 0.0, "crossing", "crossing"),  # the recording says so
    ],
)
def test_the_place_is_that_of_their_middle(
    tmp_path: Path, x: float, y: float, phase: str, place: str
) -> None:
    person = walker(line(x, y, 0, 0), crossing=":j_c0", phase=lambda t: phase)
    found = report(tmp_path, Ego(line(-100, 0, 10, 0)), person)
    assert found.encounters[0]["contact_place"] == place
    for name in ("crossing", "carriageway", "walking_area_or_kerb"):
        assert found.run[f"n_collisions_{name}"] == (name == place)


def test_beside_the_lanes_that_vehicles_use_is_the_kerb(tmp_path: Path) -> None:
    # The car leaves its lane; nobody was recorded on the sidewalk's lane.
    row = only(tmp_path, Ego(line(-100, -1.5, 10, 0)), walker(line(-40, -2.5, 0, 0)))
    assert row["contact_place"] == "walking_area_or_kerb"


def test_without_a_contact_nothing_is_said(tmp_path: Path) -> None:
    row = only(tmp_path, Ego(line(-100, 0, 10, 0)), walker(lambda t: (-20.0, 1.3 * (t - 4.0))))
    assert row["collision"] is False
    names = ("contact_place", "contact_moved_by", "contact_class", "contact_risk_seen_s")
    assert [row[name] for name in names] == [None] * 4


def test_every_collision_is_counted_once_in_each_way(tmp_path: Path) -> None:
    people = [
        walker(line(-60, 0.3, 0, 0), name="a"),
        walker(line(0, 0.3, 0, 0), name="b"),
        walker(line(-80, 0.3, 0, 0), name="c", start=1.5),
    ]
    ego = Ego(line(-100, 0, 10, 0), columns={"lane": lambda t: "road_1"})
    run = analyse_run(write_run(tmp_path, [ego], people, areas=MAP, duration=12.0)).run
    assert run["n_collisions"] == 3
    for names in (
        ("crossing", "carriageway", "walking_area_or_kerb"),
        ("class_ego", "class_rolled_off", "class_appeared", "class_touching_at_start"),
        ("moved_by_ego", "moved_by_pedestrian", "moved_by_both"),
    ):
        assert sum(run[f"n_collisions_{name}"] for name in names) == 3
    assert run["n_collisions_preventable"] == 2
    assert run["n_collisions_class_appeared"] == 1


def test_a_contact_that_lies_in_two_encounters_of_a_pair_is_one(tmp_path: Path) -> None:
    """The pedestrian crosses the ego's path 30 m before the place where they cross back and are struck."""

    def there_and_back(t: float) -> tuple[float, float]:
        if t < 6.0:
            return 0.0, -4.0 + 8.0 * t / 6.0
        if t < 26.0:
            return 1.5 * (t - 6.0), 4.0
        return 30.0, 4.0 - 8.0 * (t - 26.0) / 6.0

    def phase(t: float) -> str:
        return "crossing" if t < 6.0 or t >= 26.0 else "walking"

    # The front bumper is at x = 29.75 m at 29 s, when the pedestrian is in the middle of the lane.
    ego = Ego(lambda t: (27.5 + 8.0 * (max(t, 20.0) - 29.0), 0.0), columns={"lane": lambda t: "road_1"})
    person = walker(there_and_back, crossing="first", phase=phase)
    folder = write_run(tmp_path, [ego], [person], areas=MAP, duration=36.0)
    path = folder / "neighbours.parquet"
    table = pq.read_table(path)
    crossings = ["first" if time < 16.0 else "second" for time in table["time_s"].to_pylist()]
    number = table.schema.get_field_index("crossing_id")
    pq.write_table(table.set_column(number, "crossing_id", pa.array(crossings)), path)
    found = analyse_run(folder)
    assert [row["crossing_id"] for row in found.encounters] == ["first", "second"]
    assert all(row["t_end_s"] > 29.0 for row in found.encounters), "both hold the contact"
    assert sum(row["collision"] for row in found.encounters) == 1
    assert found.run["n_collisions"] == 1


def test_a_lane_whose_last_piece_is_short_ends_where_it_ends(tmp_path: Path) -> None:
    """The last piece is 0.5 m long; the pedestrians are struck 0.4 m before and 1.2 m after its end."""
    lane = {**LANE, "shape_m": [[-200.0, 0.0], [-20.5, 0.0], [-20.0, 0.0]]}
    places = [
        only(tmp_path / str(x), Ego(line(-100, 0, 10, 0)), walker(line(x, 0, 0, 0)), areas=(lane,))
        for x in (-20.4, -18.8)
    ]
    assert [row["contact_place"] for row in places] == ["carriageway", "walking_area_or_kerb"]
