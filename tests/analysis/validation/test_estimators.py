"""Parameters of road users: found where they were planted, undefined where nothing tells."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analysis.validation import estimate
from analysis.validation.car_following import Episode, fit, simulated_gap
from analysis.validation.estimators import estimates
from analysis.validation.gap_acceptance import critical_gap, gaps
from analysis.validation.observed import Observed
from studies.validation import planted


@pytest.fixture(scope="module")
def seen() -> Observed:
    return planted.recording(1)


def few(seen: Observed, passing: list[float], arrival: float, entry: float) -> Observed:
    """Return one pedestrian among a few vehicles."""
    vehicles = pd.concat([planted._pass(f"v{time}", time) for time in passing], ignore_index=True)
    walk = planted._walk("p", arrival, entry, 1.4)
    return replace(seen, vehicles=vehicles.sort_values(["id", "time_s"], ignore_index=True), people=walk)


@pytest.mark.long
def test_gaps_are_from_arrival_to_the_first_vehicle_and_from_vehicle_to_vehicle(seen: Observed) -> None:
    offered = gaps(few(seen, [12.0, 14.5, 21.0], arrival=10.0, entry=14.6))
    assert offered["gap_s"].tolist() == pytest.approx([2.0, 2.5, 6.5], abs=0.02)
    assert offered["accepted"].tolist() == [0.0, 0.0, 1.0]


@pytest.mark.long
def test_a_gap_without_a_next_vehicle_and_a_signal_tell_nothing(seen: Observed) -> None:
    assert len(gaps(few(seen, [12.0], arrival=10.0, entry=13.0))) == 1
    signal = replace(planted.CROSSING, crossing_kind="signal")
    assert len(gaps(replace(seen, crossings=(signal,)))) == 0


def test_nothing_is_fitted_to_few_pedestrians_or_to_gaps_that_separate_perfectly() -> None:
    rows = [(f"p{i}", gap, float(gap > 5.0)) for i in range(12) for gap in (2.0 + 0.1 * i, 6.0 + 0.1 * i)]
    table = pd.DataFrame(rows, columns=["id", "gap_s", "accepted"])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # As outside of tests, where a warning ends nothing.
        gap, _ = critical_gap(table)
        turned, _ = critical_gap(table.assign(accepted=1.0 - table["accepted"]))
    assert not gap.known
    assert gap.method == "no accepted gap is shorter than a rejected one"
    assert turned.method == "no accepted gap is longer than a rejected one"
    gap, _ = critical_gap(table[table["id"] < "p3"])
    assert not gap.known
    assert "pedestrians chose among gaps" in gap.method


def test_the_mean_of_equal_values_has_an_interval_without_width() -> None:
    found = estimate.mean("walking_speed", "m/s", np.full(6, 1.3))
    assert (found.value, found.low, found.high) == (1.3, 1.3, 1.3)


def test_a_fit_that_does_not_converge_is_undefined() -> None:
    # They overlap by a millionth of a second only.
    rejected, accepted = np.append(np.linspace(1.0, 6.0, 20), 6.000001), np.linspace(6.0000005, 12.0, 20)
    gap_s = np.concatenate([rejected, accepted])
    chosen = np.repeat([0.0, 1.0], [len(rejected), len(accepted)])
    people = [f"p{i}" for i in range(len(gap_s))]
    gap, slope = critical_gap(pd.DataFrame({"id": people, "gap_s": gap_s, "accepted": chosen}))
    assert not gap.known
    assert not slope.known
    assert gap.method == "the fit did not converge"


@pytest.mark.long
def test_planted_parameters_are_found(seen: Observed) -> None:
    found = estimates(seen)
    assert found["critical_gap"].value == pytest.approx(planted.CRITICAL_GAP_S, abs=0.8)
    assert found["walking_speed"].value == pytest.approx(planted.WALKING_MPS, abs=0.07)
    assert found["time_headway"].value == pytest.approx(planted.HEADWAY_S, abs=0.15)
    assert found["walking_speed"].n == planted.PEOPLE
    assert all(found[name].low < found[name].value < found[name].high for name in planted.PLANTED)


def test_car_following_of_the_model_itself_is_recovered() -> None:
    time = np.arange(0.0, 30.0, 0.1)
    leader = 9.0 + 3.0 * np.sin(0.4 * time) - 2.0 * (time > 15.0)
    truth = np.array([1.4, 2.5, 1.2, 1.8])
    empty = Episode("a", np.full(len(time), 20.0), np.full(len(time), 9.0), leader, 0.1)
    driven = replace(empty, gap=simulated_gap(truth, empty, 14.0))
    assert fit(driven, 14.0) == pytest.approx(truth, rel=0.02)


@pytest.mark.slow
def test_intervals_cover_what_was_planted_in_at_least_90_of_100_repeats() -> None:
    counts = planted.coverage(100)
    assert {name: count for name, count in counts.items() if count < 90} == {}
