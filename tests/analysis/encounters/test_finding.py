"""No contact of an ego and a pedestrian is missed, and none is found between two levels."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from analysis.results.analyse import RunReport, analyse_run
from tests.analysis.recorded import ZEBRA, Ego, Motion, Person, line, write_run


def analyse(folder: Path, egos: list[Ego], motion: Motion, start: float = 0.0, **keys: Any) -> RunReport:
    person = Person(motion, crossing=None, phase=lambda _: "walking", start=start)
    return analyse_run(write_run(folder, egos, [person], **keys))


def test_somebody_who_walks_along_the_lane_for_longer_than_the_range_is_hit_once(tmp_path: Path) -> None:
    """They walk 119 m before the ego catches up with them: the middle of their way is out of range."""
    ego = Ego(line(-800, 0, 10, 0), start=80.0)
    for start in (0.0, 70.0):
        report = analyse(tmp_path / f"{start:g}", [ego], line(0, 0, 1.3, 0), start, duration=100.0)
        (hit,) = (row for row in report.encounters if row["collision"])
        assert abs(hit["t_collision_s"] - (800.0 - 2.25 - 0.25) / 8.7) < 1e-6
        assert hit["entered"]
        assert report.run["n_collisions"] == 1


def test_somebody_who_leaves_the_lane_and_steps_into_it_again_far_away_is_hit(tmp_path: Path) -> None:
    """Both places are parts of one long encounter of the two."""

    def in_the_lane_twice(t: float) -> tuple[float, float]:
        beside = 0.0 if t < 10.0 else max(10.0 - t, -4.0)
        return min(5.0 + 2.0 * t, 81.0), min(beside + max(t - 38.0, 0.0), 0.0)

    report = analyse(tmp_path, [Ego(line(0, 0, 2, 0))], in_the_lane_twice, duration=60.0, areas=())
    first, second = report.encounters
    assert (first["collision"], second["collision"]) == (False, True)
    assert first["t_end_s"] < second["t_start_s"] < second["t_collision_s"]
    assert report.run["n_collisions"] == 1


def test_nobody_is_hit_under_a_bridge(tmp_path: Path) -> None:
    """They are recorded because of another ego, which stands on their own level."""
    bridge = {
        "name": "bridge_0",
        "kind": "lane",
        "width_m": 3.2,
        "shape_m": [[-100, 0], [200, 0]],
        "crossed": ["e"],
    }
    egos = [
        Ego(line(0, 0, 10, 0), name="above", columns={"lane": lambda _: "bridge_0"}),
        Ego(line(20, -40, 0, 0), name="below", columns={"lane": lambda _: "street_0"}),
    ]
    person = Person(line(32.5, -5, 0, 1.25))
    report = analyse_run(write_run(tmp_path, egos, [person], areas=(bridge, ZEBRA)))
    assert report.run["n_collisions"] == 0
    assert not any(row["ego_id"] == "above" for row in report.encounters)
