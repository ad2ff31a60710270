"""The numbers of the intermediate-speed paper's experiments, and that their claims are what the runs say."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from studies.papers.claim import Claim, Status
from studies.papers.intermediate_speed import experiments
from studies.papers.intermediate_speed.drives import Parameters
from studies.papers.intermediate_speed.experiments import Delayed, Pair

DRIVES = ("classic_drives", "new_drives", "delayed_drives", "robust_drives")


@pytest.fixture(scope="module", autouse=True)
def driven_once() -> Iterator[None]:
    """The experiments and the tests ask for the same drives; each is driven once."""
    with pytest.MonkeyPatch.context() as patch:
        for name in DRIVES:
            patch.setattr(experiments, name, cache(getattr(experiments, name)))
        yield


@pytest.fixture(scope="module")
def classic() -> Pair:
    return experiments.classic_drives()


@pytest.fixture(scope="module")
def new() -> Pair:
    return experiments.new_drives()


@pytest.fixture(scope="module")
def delayed() -> Delayed:
    return experiments.delayed_drives()


@pytest.mark.long
def test_both_planners_brake_and_stand_before_the_standing_obstacle_as_fitted(
    classic: Pair, new: Pair
) -> None:
    for drive in (classic.standing, new.standing):
        assert drive.first_braking() == pytest.approx(13.0, abs=0.015)
        assert drive.stands_from() == pytest.approx(29.0, abs=0.02)
        assert drive.gap[-1] == pytest.approx(2.5, abs=1e-3)
        assert drive.speed.max() == pytest.approx(40.0 / 3.6)


@pytest.mark.long
def test_the_new_planner_settles_behind_the_moving_obstacle(new: Pair) -> None:
    drive = new.moving
    assert drive.first_braking() == pytest.approx(30.83, abs=0.02)
    assert drive.settles() == pytest.approx(39.5, abs=0.05)
    assert drive.gap[-1] == pytest.approx(20.5, abs=1e-3)
    assert drive.after(50.0).rms_acceleration() < 1e-6


@pytest.mark.long
def test_the_classic_planner_chatters_behind_the_moving_obstacle(classic: Pair) -> None:
    drive = classic.moving
    assert drive.first_braking() == pytest.approx(23.6, abs=0.05)
    assert drive.at(50.0) == pytest.approx(5.46, abs=0.01)
    assert drive.settles() == pytest.approx(63.7, abs=0.1)
    # 0.92 m/s² in the reading, whose sampling is not told; 1.09 with the acceleration at every instant.
    assert drive.after(50.0).rms_acceleration() == pytest.approx(1.0, abs=0.12)


@pytest.mark.long
def test_the_classic_planner_s_gap_decays_with_the_analytic_time_constant(classic: Pair) -> None:
    drive = classic.moving
    part = (drive.time > 58.0) & (drive.time < 78.0)
    slope, _ = np.polyfit(drive.time[part], np.log(drive.gap[part] - drive.gap[-1]), 1)
    assert -1.0 / slope == pytest.approx(5.0 / Parameters().deceleration, rel=0.05)


@pytest.mark.long
def test_in_all_families_and_periods_the_new_planner_settles_first() -> None:
    classic, new = experiments.robust_drives()
    assert len(classic) == len(new) == 20
    speeds = [one.at(50.0) for one in classic]
    assert min(speeds) == pytest.approx(5.10, abs=0.01)
    assert max(speeds) == pytest.approx(5.59, abs=0.01)
    assert min(one.settles() for one in classic) == pytest.approx(59.5, abs=0.1)
    long_periods = [one for i, one in enumerate(classic) if experiments.PERIODS[i % 4] >= 0.5]
    assert all(np.isinf(one.settles()) for one in long_periods)
    swings = [one.after(50.0).range_of_speed() for one in classic]
    assert min(swings) == pytest.approx(0.39, abs=0.01)
    assert max(swings) == pytest.approx(1.06, abs=0.01)
    settled = [one.settles() for one in new]
    assert min(settled) == pytest.approx(37.5, abs=0.05)
    assert max(settled) == pytest.approx(41.85, abs=0.1)


@pytest.mark.slow
def test_with_slow_actuators_naive_replanning_swings_and_overruns(delayed: Delayed) -> None:
    late = delayed.naive.moving.after(80.0).speed
    assert late.min() == pytest.approx(4.60, abs=0.02)
    assert late.max() == pytest.approx(5.38, abs=0.02)
    assert late.std() == pytest.approx(0.27, abs=0.01)
    assert delayed.naive.moving.after(25.0).speed.min() == pytest.approx(4.04, abs=0.02)
    assert delayed.naive.standing.gap[-1] == pytest.approx(1.0, abs=0.05)


@pytest.mark.slow
def test_with_slow_actuators_replanning_by_events_does_not(delayed: Delayed) -> None:
    assert delayed.event.standing.gap[-1] == pytest.approx(2.5, abs=0.02)
    # 43.6 s in the reading, which takes a plan for over when its last command is given, not when it acts.
    assert delayed.event.moving.settles() == pytest.approx(43.6 + 0.7, abs=0.2)
    assert delayed.event.moving.after(60.0).range_of_speed() < 0.01


@pytest.mark.slow
def test_with_slow_actuators_a_plan_from_the_predicted_state_is_exact(delayed: Delayed) -> None:
    assert delayed.predicted.standing.gap[-1] == pytest.approx(2.5, abs=0.02)
    assert delayed.predicted.moving.gap[-1] == pytest.approx(24.0, abs=0.01)
    assert delayed.predicted.moving.settles() < 41.0


@pytest.mark.slow
def test_every_claim_has_a_status_and_the_wide_swings_are_not_reproduced(tmp_path: Path) -> None:
    claims: list[Claim] = experiments.run(tmp_path)
    missed = [claim for claim in claims if claim.status is Status.NOT_REPRODUCED]
    assert ["Fig. 3" in claim.claim for claim in missed] == [True]
    assert all(claim.why for claim in missed)
    fitted = {claim.paper_value for claim in claims if claim.status is Status.FITTED}
    assert fitted == {"13", "29"}
    assert len(claims) > 20
    assert {path.name for path in tmp_path.iterdir()} == {
        "004-speed-plans.png",
        "004-actuator-delay.png",
        "004-chatter.png",
        "004-six-cases.png",
        "004-jerk-limit.png",
    }


def test_the_figure_of_the_six_cases_shows_each_of_them() -> None:
    from studies.papers.intermediate_speed.case_figures import CASES, cases
    from studies.papers.intermediate_speed.drives import Parameters

    assert cases(Parameters().limits()) == {name: name for name in CASES}
