"""The manual's delay formula against a worked example."""

from __future__ import annotations

import pytest

from analysis.encounters.hcm import crossing_delay, level_of_service

FOOT = 0.3048


def test_the_worked_example_of_two_stages_gives_its_printed_delay() -> None:
    first = crossing_delay(22 * FOOT, 0.200, 0.41, walking_speed=3.5 * FOOT)
    second = crossing_delay(22 * FOOT, 0.150, 0.0, walking_speed=4.0 * FOOT)
    assert first == pytest.approx(5.19, abs=0.005)
    assert second == pytest.approx(8.69, abs=0.005)
    assert level_of_service(first + second) == "C"


def test_more_drivers_who_yield_shorten_the_wait_and_all_of_them_nearly_end_it() -> None:
    delays = [crossing_delay(7.0, 0.2, rate) for rate in (0.0, 0.25, 0.5, 0.75, 1.0)]
    assert delays == sorted(delays, reverse=True)
    assert delays[-1] < 2.0


@pytest.mark.parametrize("wrong", [(0.0, 0.2, 0.5), (7.0, 0.0, 0.5), (7.0, 0.2, 1.5)])
def test_what_cannot_be_is_refused(wrong: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="not"):
        crossing_delay(*wrong)
