"""Colours, points and verdicts of test protocols, as functions of numbers."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.protocols.colours import COLOURS, FACTORS, colour, worse
from analysis.protocols.impact import Impact, Measured
from analysis.protocols.verdict import Demand, compared, decide


def impact(kmh: float, across: float = 0.0, side: str = "front") -> Impact:
    return Impact(5.0, kmh / 3.6, kmh / 3.6, across, 1.8, side)


def measured(
    kmh: float | None = None,
    *,
    stopped: bool = False,
    after_stop: bool = False,
    deceleration: float = 0.0,
    preventable: bool | None = True,
    near: bool = True,
    walked: bool = True,
) -> Measured:
    hit = None if kmh is None else impact(kmh)
    return Measured(hit, after_stop, stopped, deceleration, preventable, near, walked)


@pytest.mark.parametrize("rule", ["no_contact", "green", "not_red", "no_false_stop"])
def test_a_test_that_did_not_take_place_is_not_passed(rule: str) -> None:
    for seen in (measured(near=False), measured(walked=False)):
        verdict = decide(seen, Demand(rule, 40.0))
        assert (verdict.passed, verdict.counts, verdict.colour) == (False, True, "")
        assert verdict.points in (0.0, None)
        assert verdict.note.startswith("no test: ")
        assert compared(verdict, verdict) == compared(verdict, decide(measured(), Demand("green", 40.0)))
        assert not compared(verdict, verdict).passed
    # Who stands in the way, or walks along it, need not set off.
    assert decide(measured(walked=False), Demand(rule, 40.0, in_view=True)).passed
    assert not decide(measured(near=False), Demand(rule, 40.0, in_view=True)).passed


@pytest.mark.parametrize(
    ("test_speed", "impact_speed", "expected"),
    [
        (10.0, None, "green"),
        (10.0, 0.1, "red"),
        (20.0, 0.1, "red"),
        (30.0, 9.9, "brown"),
        (30.0, 10.0, "red"),
        (40.0, 9.9, "orange"),
        (40.0, 10.0, "brown"),
        (40.0, 19.9, "brown"),
        (40.0, 20.0, "red"),
        (50.0, 9.9, "yellow"),
        (60.0, 10.0, "orange"),
        (60.0, 20.0, "brown"),
        (60.0, 29.9, "brown"),
        (60.0, 30.0, "red"),
    ],
)
def test_colours_at_the_borders_of_their_bands(
    test_speed: float, impact_speed: float | None, expected: str
) -> None:
    assert colour(test_speed, impact_speed) == expected
    assert colour(test_speed, impact_speed, avoidance_only=True) == (
        "green" if impact_speed is None else "red"
    )


@given(st.sampled_from([10.0, 20.0, 30.0, 40.0, 50.0, 60.0]), st.floats(0, 80), st.floats(0, 80))
def test_a_harder_impact_has_no_better_colour(test_speed: float, one: float, other: float) -> None:
    softer, harder = sorted((one, other))
    assert not worse(colour(test_speed, softer), colour(test_speed, harder))
    assert FACTORS[colour(test_speed, softer)] >= FACTORS[colour(test_speed, harder)]


def test_factors_fall_from_the_best_colour_to_the_worst() -> None:
    assert [FACTORS[name] for name in COLOURS] == [1.0, 0.75, 0.5, 0.25, 0.0]


def test_overlap_counts_from_the_side_that_they_came_from() -> None:
    assert impact(30.0, across=-0.45).overlap(from_left=False) == pytest.approx(0.25)
    assert impact(30.0, across=-0.45).overlap(from_left=True) == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("demand", "what", "passed"),
    [
        (Demand("no_contact", 30.0), measured(), True),
        (Demand("no_contact", 30.0), measured(0.1), False),
        (Demand("impact_speed", 50.0, 25.0), measured(25.0), True),
        (Demand("impact_speed", 50.0, 25.0), measured(25.1), False),
        (Demand("impact_speed", 50.0, 25.0), measured(0.0), True),
        (Demand("impact_speed", 40.0, 0.0), measured(0.0), False),
        (Demand("impact_speed", 40.0, 0.0), measured(0.1), False),
        (Demand("impact_speed", 40.0, 0.0), measured(), True),
        (Demand("green", 60.0), measured(), True),
        (Demand("green", 60.0), measured(5.0), False),
        (Demand("not_red", 60.0), measured(29.0), True),
        (Demand("not_red", 60.0), measured(31.0), False),
        (Demand("no_false_stop", 30.0), measured(deceleration=6.0), True),
        (Demand("no_false_stop", 30.0), measured(stopped=True), False),
        (Demand("no_false_braking", 30.0), measured(deceleration=4.9), True),
        (Demand("no_false_braking", 30.0), measured(deceleration=5.0), False),
        (Demand("no_false_braking", 30.0), measured(1.0), False),
    ],
)
def test_rules_at_their_borders(demand: Demand, what: Measured, passed: bool) -> None:
    verdict = decide(what, demand)
    assert verdict.passed is passed
    assert bool(verdict.note) is not passed
    assert verdict.counts is not passed


def test_what_nobody_could_have_prevented_does_not_count() -> None:
    verdict = decide(measured(20.0, preventable=False), Demand("no_contact", 50.0))
    assert (verdict.passed, verdict.preventable, verdict.counts) == (False, False, False)
    assert decide(measured(20.0, preventable=None), Demand("no_contact", 50.0)).counts, "undefined counts"
    assert decide(measured(20.0, preventable=False), Demand("no_contact", 50.0, in_view=True)).counts


def test_no_worse_is_held_against_the_standard_case() -> None:
    standard = decide(measured(15.0), Demand("green", 50.0))
    better, same, worst = (decide(measured(kmh), Demand("no_worse", 50.0)) for kmh in (5.0, 18.0, 35.0))
    assert not better.passed, "alone it is held against green"
    assert [compared(one, standard).passed for one in (better, same, worst)] == [True, True, False]
    assert "in the standard case orange" in compared(worst, standard).note


def test_a_contact_after_a_stop_is_told() -> None:
    verdict = decide(measured(5.0, stopped=True, after_stop=True), Demand("no_contact", 30.0))
    assert "after the ego had stopped" in verdict.note
