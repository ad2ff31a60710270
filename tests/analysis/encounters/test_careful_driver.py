"""The replay of the careful driver on constructed cases whose answer is known."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from analysis.results.analyse import analyse_run
from analysis.thresholds import Thresholds
from tests.analysis.recorded import Ego, Motion, Person, Vehicle, line, write_run


def only(folder: Path, ego: Ego, person: Person, *vehicles: Vehicle, **keys: Any) -> dict[str, Any]:
    write_run(folder, [ego], [person], vehicles, areas=(), **{"step": 0.05, **keys})
    (row,) = analyse_run(folder).encounters
    return dict(row)


def walker(motion: Motion, **keys: Any) -> Person:
    return Person(motion, crossing=None, phase=lambda t: "walking", **keys)


def steps_out(x: float, when: float, side: float = 3.0) -> Callable[[float], tuple[float, float]]:
    """Return the motion of somebody who is in the middle of the lane from one instant to the next."""
    return lambda t: (x, 0.0 if t >= when else side)


def driving(kmh: float) -> Motion:
    return line(-100.0, 0.0, kmh / 3.6, 0.0)


def ahead(kmh: float, when: float, distance: float) -> float:
    """Return where somebody stands whose surface is that far before the bumper at that instant."""
    return -100.0 + kmh / 3.6 * when + 2.25 + distance + 0.25


def test_somebody_who_stands_in_the_lane_and_is_seen_for_ten_seconds_is_spared(tmp_path: Path) -> None:
    ego = Ego(line(-100.0, 0.0, 10.0, 0.0))
    row = only(tmp_path, ego, walker(line(2.5, 0.3, 0, 0)), duration=14.0)
    assert row["collision"] is True
    assert row["t_collision_s"] == pytest.approx(10.0, abs=1e-3)
    assert row["preventable_r157"] is True


@pytest.mark.parametrize(
    ("kmh", "distance", "spared"),
    [
        # 27.2 m are needed at 50 km/h, 7.75 m at 20 km/h.
        (50.0, 3.0, False),
        (50.0, 10.0, False),
        (50.0, 20.0, False),
        (50.0, 25.5, False),
        (50.0, 30.0, True),
        (20.0, 3.0, False),
        (20.0, 7.0, False),
        (20.0, 10.0, True),
    ],
)
@pytest.mark.parametrize("step", [0.05, 0.1])
def test_somebody_who_steps_out_at_once_is_spared_from_the_stopping_distance_on(
    tmp_path: Path, kmh: float, distance: float, spared: bool, step: float
) -> None:
    person = walker(steps_out(ahead(kmh, 3.0, distance), 3.0))
    row = only(tmp_path, Ego(driving(kmh)), person, step=step, duration=14.0)
    assert row["collision"] is True
    assert row["impact_speed_kmh"] == pytest.approx(kmh, abs=0.01)
    assert row["preventable_r157"] is spared


def test_the_reaction_time_may_include_the_evaluation_of_the_risk(tmp_path: Path) -> None:
    person = walker(steps_out(ahead(50.0, 3.0, 30.0), 3.0))
    write_run(tmp_path, [Ego(driving(50.0))], [person], areas=(), step=0.05)
    (row,) = analyse_run(tmp_path, Thresholds(r157_reaction_s=1.15)).encounters
    assert row["preventable_r157"] is False, "32.7 m are needed with 1.15 s"


def turning(speed: float, radius: float) -> Motion:
    """Return the motion of a car's centre whose rear axle turns left from t = 5 s on, 90 degrees."""
    rate, lever = speed / radius, 2.25 - 0.95

    def centre(t: float) -> tuple[float, float]:
        angle = min(max(t - 5.0, 0.0) * rate, math.pi / 2)
        straight, beyond = speed * min(t - 5.0, 0.0), speed * max(t - 5.0 - math.pi / 2 / rate, 0.0)
        x = straight + radius * math.sin(angle) + lever * math.cos(angle)
        y = radius * (1 - math.cos(angle)) + lever * math.sin(angle) + beyond
        return x, y

    return centre


def test_somebody_inside_the_swept_front_corner_of_a_turning_ego_is_spared(tmp_path: Path) -> None:
    # The heading of a recorded row here is the direction of the centre's motion, so the outer front corner
    # of the body is at half the length before it and half the width to its right.
    speed, radius = 20 / 3.6, 8.0
    outer = math.hypot(math.hypot(radius, 1.3) + 0.9, 2.25)
    reach = outer - 0.2 + 0.25  # the disc reaches 0.2 m into what the corner sweeps
    angle = math.radians(-40.0)
    person = walker(
        lambda t: (reach * math.cos(angle), radius + reach * math.sin(angle)), start=2.5, radius=0.25
    )
    row = only(tmp_path, Ego(turning(speed, radius)), person, duration=12.0)
    assert row["collision"] is True
    assert row["t_collision_s"] > 5.5
    assert row["conflict_type"] == "turning"
    assert row["preventable_r157"] is True


def test_somebody_outside_what_a_turning_ego_sweeps_is_not_touched(tmp_path: Path) -> None:
    speed, radius = 20 / 3.6, 8.0
    outer = math.hypot(math.hypot(radius, 1.3) + 0.9, 2.25)
    angle = math.radians(-40.0)
    reach = outer + 0.25 + 0.05
    person = Person(
        lambda t: (reach * math.cos(angle), radius + reach * math.sin(angle)), phase=lambda t: "waiting"
    )
    row = only(tmp_path, Ego(turning(speed, radius)), person, duration=12.0)
    assert row["collision"] is False


def test_a_turning_ego_cannot_spare_somebody_who_steps_before_its_corner(tmp_path: Path) -> None:
    speed, radius = 20 / 3.6, 8.0
    outer = math.hypot(math.hypot(radius, 1.3) + 0.9, 2.25)
    angle = math.radians(-40.0)

    def steps(t: float) -> tuple[float, float]:
        reach = outer - 0.2 + 0.25 if t >= 5.3 else outer + 4.0
        return reach * math.cos(angle), radius + reach * math.sin(angle)

    row = only(tmp_path, Ego(turning(speed, radius)), walker(steps), duration=12.0)
    assert row["collision"] is True
    assert row["preventable_r157"] is False


def test_a_walker_is_foreseen_two_seconds_ahead(tmp_path: Path) -> None:
    # At 50 km/h 1.96 s are needed. The pedestrian walks at 1.5 m/s to the middle of the lane and is struck
    # there: the disc is less than 0.375 m from the corridor for 1.0 s only, but was seen to approach.
    person = walker(lambda t: (ahead(50.0, 6.0, 0.0), -1.5 * (6.0 - t)))
    row = only(tmp_path, Ego(driving(50.0)), person)
    assert row["collision"] is True
    assert row["preventable_r157"] is True


def test_a_walker_who_turns_into_the_lane_at_once_is_not(tmp_path: Path) -> None:
    def turns(t: float) -> tuple[float, float]:
        # Along the kerb until 5 s, then into the lane.
        there = ahead(50.0, 6.0, 0.0)
        return (there - 1.5 * max(5.0 - t, 0.0), -1.9 + 1.9 * min(max(t - 5.0, 0.0), 1.0))

    row = only(tmp_path, Ego(driving(50.0)), walker(turns))
    assert row["collision"] is True
    assert row["preventable_r157"] is False


def test_somebody_hidden_by_a_vehicle_until_it_is_too_late_is_not_spared(tmp_path: Path) -> None:
    # A pedestrian in front of a lorry parked beside the lane runs out 10 m before an ego at 50 km/h; its
    # driver sees them past the corner of the lorry 6 m before the bumper.
    out = ahead(50.0, 5.0, 6.0)

    def runs(t: float) -> tuple[float, float]:
        return out, min(-3.0 + 3.0 * max(t - 4.5, 0.0), 0.0)

    lorry = Vehicle(line(out - 1.0 - 5.0, -2.6, 0, 0), "lorry", length=10.0, width=2.5)
    hidden = only(tmp_path / "hidden", Ego(driving(50.0)), walker(runs), lorry)
    assert hidden["collision"] is True
    assert hidden["preventable_r157"] is False
    early = walker(lambda t: (out, min(-3.0 + 3.0 * max(t - 2.0, 0.0), 0.0)))
    hidden_early = only(tmp_path / "early", Ego(driving(50.0)), early, lorry)
    assert hidden_early["preventable_r157"] is True, "who runs out 3 s before is seen in time"


def test_somebody_who_is_hidden_for_a_while_is_not_forgotten(tmp_path: Path) -> None:
    """A car on the other lane briefly hides a pedestrian who stands in the lane all the time."""
    there = 20.0
    car = Vehicle(line(there + 60.0, 1.2, -14.0, 0.0), "oncoming", width=1.2)
    row = only(tmp_path, Ego(line(-100.0, 0, 13.0, 0.0)), walker(line(there, 0, 0, 0)), car)
    assert row["preventable_r157"] is True


def test_who_crossed_long_before_and_comes_back_is_seen_anew(tmp_path: Path) -> None:
    """The pedestrian leaves the ego's path, is seen outside for 3 s, and steps back 5 m before the bumper."""

    def returns(t: float) -> tuple[float, float]:
        there = ahead(50.0, 6.0, 5.0)
        return there, 0.0 if t < 2.0 or t >= 6.0 else -4.0

    row = only(tmp_path, Ego(driving(50.0)), walker(returns))
    assert row["collision"] is True
    assert row["preventable_r157"] is False


def test_the_careful_driver_keeps_the_limit(tmp_path: Path) -> None:
    """At 50 km/h 28.5 m are enough; the ego drove at 80 km/h."""
    person = walker(steps_out(ahead(80.0, 3.0, 35.0), 3.0))
    slow = Ego(driving(80.0), columns={"speed_limit_mps": lambda t: 13.89})
    assert only(tmp_path / "limit", slow, person)["preventable_r157"] is True
    free = Ego(driving(80.0), columns={"speed_limit_mps": lambda t: None})
    assert only(tmp_path / "none", free, person)["preventable_r157"] is False


def test_braking_that_the_ego_had_begun_is_not_given_up(tmp_path: Path) -> None:
    """It brakes with 7 m/s² from 60 km/h for a pedestrian; with released brakes it would reach them."""

    def brakes(t: float) -> tuple[float, float]:
        s = 60 / 3.6 * t
        if t > 2.0:
            u = min(t - 2.0, 2.0)
            s = 60 / 3.6 * (2.0 + u) - 3.5 * u * u + max(t - 4.0, 0.0) * (60 / 3.6 - 14.0)
        return -100.0 + s, 0.0

    # 19.8 m after the brakes have begun, where the ego still drives at 9.6 km/h.
    there = brakes(4.2)[0] + 2.5
    person = walker(lambda t: (there, 0.0 if t >= 2.5 else 3.0))
    row = only(tmp_path, Ego(brakes), person)
    assert row["collision"] is True
    assert row["preventable_r157"] is True


def test_somebody_who_leaves_in_time_is_spared_though_the_replay_does_not_stop_before_them(
    tmp_path: Path,
) -> None:
    """A runner is 3 cm short of having left: a little braking is enough, a stop is not needed."""
    there = ahead(50.0, 3.0, 20.0)

    def runs(t: float) -> tuple[float, float]:
        return there, -1.3 + 1.68 * (t - 3.0) if t > 3.0 else -5.0

    row = only(tmp_path, Ego(driving(50.0)), walker(runs))
    assert row["collision"] is True
    assert row["preventable_r157"] is True


def test_an_ego_that_rolls_off_against_somebody_beside_it_could_have_waited(tmp_path: Path) -> None:
    def rolls(t: float) -> tuple[float, float]:
        return max(t - 4.0, 0.0) ** 2, 0.0

    person = walker(lambda t: (2.25 + 0.5, -3.0 + min(t, 3.0)))
    row = only(tmp_path, Ego(rolls), person)
    assert row["collision"] is True
    assert row["preventable_r157"] is True


def test_a_touch_at_the_first_sample_cannot_be_prevented(tmp_path: Path) -> None:
    ego = Ego(driving(36.0))
    row = only(tmp_path, ego, walker(line(-97.0 + 30.0, 0, 0, 0), start=3.0))
    assert row["collision"] is True
    assert row["preventable_r157"] is False


def test_the_ego_itself_hides_nobody_though_it_is_recorded_as_a_vehicle(tmp_path: Path) -> None:
    itself = Vehicle(driving(36.0), "ego")
    row = only(tmp_path, Ego(driving(36.0)), walker(line(-20.0, 0.3, 0, 0)), itself)
    assert row["preventable_r157"] is True


def test_who_leaves_the_lane_for_a_second_and_comes_back_was_a_risk_all_along(tmp_path: Path) -> None:
    """Seen outside for 1 s, less than the 2 s after which the driver would drive on."""

    def returns(t: float) -> tuple[float, float]:
        there = ahead(50.0, 6.0, 5.0)
        return there, 0.0 if t < 5.0 or t >= 6.0 else -2.0

    row = only(tmp_path, Ego(driving(50.0)), walker(returns))
    assert row["collision"] is True
    assert row["preventable_r157"] is True
