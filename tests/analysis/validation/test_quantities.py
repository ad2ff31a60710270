"""Quantities of road users, worked out by hand from a few samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analysis.recording.reading import Area
from analysis.validation.car_following import Episode, episodes, simulated_gap
from analysis.validation.gap_acceptance import critical_gap, passages
from analysis.validation.observed import Observed
from analysis.validation.quantities import QUANTITIES, Quantity

STEP = 0.1
QUANTITY = {one.name: one for one in QUANTITIES}


def vehicle(
    name: str,
    speed: Callable[[float], float],
    *,
    kind: str = "passenger",
    start: float = 0.0,
    seconds: float = 4.0,
    across: Callable[[float], float] = lambda t: 0.0,
) -> pd.DataFrame:
    """Return a vehicle of 4 m on one lane, from a place on [m]; times are multiples of the step."""
    times = np.round(np.arange(0.0, seconds + 0.5 * STEP, STEP), 6)
    speeds = np.array([speed(t) for t in times])
    along = start + np.concatenate([[0.0], np.cumsum(speeds[1:] * STEP)])
    return pd.DataFrame(
        {
            "id": name,
            "class": kind,
            "time_s": times,
            "x_m": along,
            "y_m": 0.0,
            "speed_mps": speeds,
            "lane": "in_0",
            "along_m": along,
            "across_m": [across(t) for t in times],
            "length_m": 4.0,
        }
    )


def person(name: str, *phases: tuple[str, float, float]) -> pd.DataFrame:
    """Return a pedestrian who is in each phase for a time [s] at a speed [m/s]."""
    rows = [(phase, speed) for phase, seconds, speed in phases for _ in range(round(seconds / STEP))]
    times = np.round(np.arange(len(rows)) * STEP, 6)
    return pd.DataFrame(
        {
            "id": name,
            "time_s": times,
            "x_m": 0.0,
            "y_m": 0.0,
            "speed_mps": [speed for _, speed in rows],
            "phase": [phase for phase, _ in rows],
            "crossing": "c",
        }
    )


def seen(
    vehicles: Sequence[pd.DataFrame] = (),
    people: Sequence[pd.DataFrame] = (),
    encounters: Sequence[tuple[str, str, str, str, str]] = (),
) -> Observed:
    columns = ["ped_id", "entered", "min_dist_m", "pet_area_s", "yielded"]
    return Observed(
        pd.concat([*vehicles, vehicle("far", lambda t: 0.0, start=1e4)], ignore_index=True),
        pd.concat([*people, person("stands", ("", 0.5, 0.0))], ignore_index=True),
        pd.DataFrame(list(encounters), columns=columns),
        (),
        STEP,
    )


def values(quantity: Quantity, found: Observed) -> dict[str, float]:
    return {str(name): float(value) for name, value in quantity.values(found).dropna().items()}


def test_a_speed_is_the_mean_while_a_vehicle_moves_and_its_class_counts() -> None:
    found = seen(
        [
            vehicle("a", lambda t: 4.0 if t < 2.0 else 8.0),  # 20 samples and 21
            vehicle("stood", lambda t: 0.0 if t < 1.5 else 5.0),
            vehicle("brief", lambda t: 5.0, seconds=1.0),
            vehicle("b", lambda t: 4.5, kind="bicycle"),
        ]
    )
    cars = values(QUANTITY["car_speed"], found)
    assert cars == pytest.approx({"a": (20 * 4.0 + 21 * 8.0) / 41, "stood": 5.0})
    assert values(QUANTITY["bicycle_speed"], found) == pytest.approx({"b": 4.5})


def test_how_long_a_vehicle_was_seen_is_told_by_the_step() -> None:
    # 5 samples that are 0.5 s apart are 2.5 s, of which 0.1 s would make half a second.
    slow = vehicle("a", lambda t: 5.0, seconds=2.0).iloc[::5]
    found = replace(seen([slow, vehicle("brief", lambda t: 5.0, seconds=0.5).iloc[::5]]), step_s=0.5)
    assert values(QUANTITY["car_speed"], found) == pytest.approx({"a": 5.0})


def test_accelerations_are_changes_of_speed_over_a_second() -> None:
    found = seen(
        [
            vehicle("quick", lambda t: 5.0 + 2.0 * min(t, 2.0)),
            vehicle("hard", lambda t: max(12.0 - 3.0 * t, 0.0)),
            vehicle("steady", lambda t: 7.0 + 0.5 * t),
            # One sample of noise moves a change over a second by as much as the speed.
            vehicle("noisy", lambda t: 9.0 + 1.5 * (round(t, 1) == 2.0)),
        ]
    )
    assert values(QUANTITY["car_acceleration"], found) == pytest.approx({"quick": 2.0, "noisy": 1.5})
    assert values(QUANTITY["car_braking"], found) == pytest.approx({"hard": 3.0, "noisy": 1.5})


def test_a_headway_is_from_front_to_front_over_the_follower_s_speed() -> None:
    lead, behind = vehicle("lead", lambda t: 8.0, start=20.0), vehicle("behind", lambda t: 8.0)
    slow = vehicle("slow", lambda t: 2.0, start=-10.0)  # too slow to follow
    assert values(QUANTITY["time_headway"], seen([lead, behind, slow])) == pytest.approx({"behind": 2.5})
    other = behind.assign(lane="in_1")
    assert values(QUANTITY["time_headway"], seen([lead, other])) == {}


def test_offset_and_spread_are_of_the_lane_s_axis() -> None:
    swerves = vehicle("a", lambda t: 6.0, across=lambda t: 0.5 if t < 2.0 else -0.3)
    aside = vehicle("b", lambda t: 6.0, across=lambda t: 2.5)  # in no lane any more
    found = seen([swerves, aside])
    assert values(QUANTITY["lateral_offset"], found) == pytest.approx({"a": (20 * 0.5 - 21 * 0.3) / 41})
    assert values(QUANTITY["lateral_spread"], found) == pytest.approx({"a": (20 * 0.5 + 21 * 0.3) / 41})


def test_people_walk_wait_and_cross() -> None:
    crosses = person(
        "a", ("walking", 2.0, 1.5), ("waiting", 3.0, 0.0), ("crossing", 4.0, 1.2), ("", 1.0, 1.5)
    )
    cut = person("b", ("crossing", 4.0, 1.0))  # came into view on it
    turns = person("c", ("waiting", 2.0, 0.0), ("", 2.5, 1.4))  # never crosses
    found = seen(people=[crosses, cut, turns])
    # 20 samples of 1.5, 40 of 1.2 and 10 of 1.5: the median of 70 is the lower speed.
    assert values(QUANTITY["walking_speed"], found) == pytest.approx({"a": 1.2, "b": 1.0, "c": 1.4})
    assert values(QUANTITY["crossing_time"], found) == pytest.approx({"a": 3.9})
    assert values(QUANTITY["waiting_time"], found) == pytest.approx({"a": 3.0, "b": 0.0})


def test_encounters_count_where_the_pedestrian_entered() -> None:
    found = seen(
        encounters=[
            ("a", "1", "2.5", "1.5", "1"),
            ("a", "1", "0.5", "", "0"),
            ("a", "0", "0.1", "0.2", "0"),
            ("b", "1", "3.0", "4.0", "1"),
        ]
    )
    assert values(QUANTITY["smallest_distance"], found) == {"a": 0.5, "b": 3.0}
    assert values(QUANTITY["smallest_pet"], found) == {"a": 1.5, "b": 4.0}
    assert values(QUANTITY["yielding"], found) == {"a": 0.5, "b": 1.0}


def test_a_passage_is_between_two_samples_of_one_vehicle() -> None:
    crossing = Area("c", "crossing", "zebra", 4.0, np.array([[10.05, -5.0], [10.05, 5.0]]))
    over = vehicle("a", lambda t: 5.0, start=5.0)  # at 10.05 m after 1.01 s
    before = vehicle("b", lambda t: 1.0, start=0.0)
    beyond = vehicle("c", lambda t: 5.0, start=20.0)
    aside = vehicle("d", lambda t: 5.0, start=5.0).assign(y_m=7.0)
    (found,) = passages(pd.concat([before, beyond, over, aside], ignore_index=True), crossing)
    assert found.vehicle == "a"
    assert found.time_s == pytest.approx(1.01)


@pytest.mark.parametrize(("fastest", "lasts", "many"), [(3.0, 9.0, 0), (3.2, 9.0, 1), (3.2, 7.0, 0)])
def test_an_episode_of_following_is_long_and_says_something(fastest: float, lasts: float, many: int) -> None:
    lead = vehicle("lead", lambda t: 2.0, start=30.0, seconds=lasts)
    behind = vehicle("behind", lambda t: fastest if t < 3.0 else 1.5, seconds=lasts)
    found = list(episodes(seen([lead, behind])))
    assert len(found) == many
    for one in found:
        assert one.car == "behind"
        assert one.gap[0] == pytest.approx(26.0)  # from the front to a rear 4 m behind the leader's front


def test_the_model_brakes_for_what_is_nearer_than_wanted() -> None:
    """T = 1 s, s0 = 2 m, a = 2 m/s^2, b = 4.5 m/s^2: 2 sqrt(a b) = 6 m/s^2; v0 = 20 m/s."""
    episode = Episode("a", np.full(2, 20.0), np.full(2, 10.0), np.array([4.0, 4.0]), 0.5)
    # s* = 2 + 10 + 10 · 6 / 6 = 22; a (1 - 0.5^4 - 1.1^2) = -0.545; after half a second 9.7275 m/s.
    gaps = simulated_gap(np.array([1.0, 2.0, 2.0, 4.5]), episode, 20.0)
    assert gaps == pytest.approx([20.0, 20.0 + 0.5 * (4.0 - 0.5 * (10.0 + 9.7275))])


def test_the_interval_of_the_critical_gap_lies_evenly_around_it_and_shrinks_with_people() -> None:
    def offered(people: int) -> pd.DataFrame:
        rng = np.random.default_rng(2)
        gap = rng.uniform(1.0, 9.0, (people, 3))
        taken = rng.random(gap.shape) < 1.0 / (1.0 + np.exp(-1.5 * (gap - 5.0)))
        names = np.repeat([f"p{number}" for number in range(people)], 3)
        return pd.DataFrame({"id": names, "gap_s": gap.ravel(), "accepted": taken.ravel().astype(float)})

    few, many = (critical_gap(offered(people)) for people in (50, 800))
    for found in (*few, *many):
        assert found.high - found.value == pytest.approx(found.value - found.low)
    assert few[0].value == pytest.approx(5.0, abs=0.5)
    assert many[1].low < 1.5 < many[1].high
    # Sixteen times as many people: a quarter of the width.
    assert (many[0].high - many[0].low) / (few[0].high - few[0].low) == pytest.approx(0.25, rel=0.25)


def test_nothing_seen_gives_no_values() -> None:
    empty = seen()
    nobody = replace(empty, vehicles=empty.vehicles.iloc[:0], people=empty.people.iloc[:0])
    assert all(values(one, nobody) == {} for one in QUANTITIES)
