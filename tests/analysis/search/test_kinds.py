"""Failures that are alike are one kind."""

from __future__ import annotations

from analysis.search.axes import Axis, Point
from analysis.search.kinds import Failure, kinds

AXES = (
    Axis("gap_s", 0.0, 10.0),
    Axis("manner", choices=("steady", "running")),
    Axis("run_speed_mps", 2.0, 4.0, when=(("manner", ("running",)),)),
)
HIT = {"collision": "1", "impact_speed_kmh": "40", "impact_side": "front", "contact_place": "carriageway"}


def failure(trial: int, margin: float, point: Point, facts: dict[str, str] = HIT) -> Failure:
    return Failure(trial, 1, point, margin, "no preventable contact", facts)


def at(gap: float, manner: str = "steady", speed: float = 3.0) -> Point:
    return {"gap_s": gap, "manner": manner, "run_speed_mps": speed}


def test_failures_far_apart_in_the_space_are_two_kinds_the_clearest_first() -> None:
    found = kinds(AXES, [failure(1, -0.2, at(1.0)), failure(2, -0.5, at(1.5)), failure(3, -0.6, at(9.0))])
    assert [[one.trial for one in kind.failures] for kind in found] == [[3], [2, 1]]
    assert found[1].name == "contact hard at the front on the carriageway: manner steady, gap_s 1 to 1.5"


def test_a_chain_of_near_failures_is_one_kind() -> None:
    chain = [failure(number, -0.5, at(float(number))) for number in range(10)]
    (kind,) = kinds(AXES, chain)
    # It covers most of the axis, which therefore does not tell it from others.
    assert kind.name == "contact hard at the front on the carriageway: manner steady"


def test_what_changes_nothing_separates_no_kinds() -> None:
    (kind,) = kinds(AXES, [failure(1, -0.5, at(1.0, speed=2.0)), failure(2, -0.5, at(1.0, speed=4.0))])
    assert "run_speed_mps" not in kind.name
    running = kinds(
        AXES, [failure(1, -0.5, at(1.0, "running", 2.0)), failure(2, -0.5, at(1.0, "running", 4.0))]
    )
    assert len(running) == 2


def test_another_happening_is_another_kind() -> None:
    slow = {**HIT, "impact_speed_kmh": "5", "contact_moved_by": "pedestrian"}
    found = kinds(AXES, [failure(1, -0.5, at(1.0)), failure(2, -0.3, at(1.0), slow)])
    assert [kind.name.partition(":")[0] for kind in found] == [
        "contact hard at the front on the carriageway",
        "contact slow at the front on the carriageway that the pedestrian closed",
    ]


def test_kinds_that_would_be_called_the_same_are_numbered() -> None:
    facts = {"collision": "0"}
    axes = (Axis("gap_s", 0.0, 10.0), Axis("other", 0.0, 1.0))
    found = kinds(
        axes,
        [
            Failure(1, 1, {"gap_s": 0.0, "other": 0.0}, -0.5, "no deadlock", facts),
            Failure(2, 1, {"gap_s": 10.0, "other": 1.0}, -0.4, "no deadlock", facts),
        ],
    )
    assert [kind.name for kind in found] == [
        "no deadlock: not met: gap_s 0, other 0",
        "no deadlock: not met: gap_s 10, other 1",
    ]
