"""The scenario of the decision rules shows each of them, decided by vo_mpc in SUMO's traffic."""

from __future__ import annotations

import pandas as pd
import pytest

from controllers.interface import Manoeuvre
from controllers.velocity_obstacle.decision_rules import Rule
from cosim.running.request import RunRequest
from cosim.running.simulation import run

pytestmark = [pytest.mark.sumo, pytest.mark.long]

ZEBRA_BEGINS_M = 1190.0


@pytest.fixture(scope="module", params=[1, pytest.param(2, marks=pytest.mark.slow)])
def plans(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> pd.DataFrame:
    """What the only ego decided, plan by plan, until it has passed the zebra or nearly so."""
    out = tmp_path_factory.mktemp("rules") / "run"
    result = run(RunRequest("decision_rules", "vo_mpc", seed=request.param, duration_s=120.0, out=out))
    assert result.valid, result.invalid_reason
    egos = pd.read_parquet(out / "egos.parquet")
    assert not egos["intervention"].any()
    return egos[egos["planned"]].reset_index(drop=True)


def test_straight_lane_change_and_autonomous_each_occur_for_a_second_and_in_their_order(
    plans: pd.DataFrame,
) -> None:
    count = plans["rule"].value_counts()
    assert all(count[rule.value] >= 10 for rule in Rule)
    first = {rule: int((plans["rule"] == rule.value).to_numpy().argmax()) for rule in Rule}
    assert first[Rule.AUTONOMOUS] < first[Rule.STRAIGHT] < first[Rule.LANE_CHANGE]


def test_straight_holds_while_the_dense_column_is_beside(plans: pd.DataFrame) -> None:
    beside = plans[["gap_left_ahead_m", "gap_left_behind_m"]].min(axis=1)
    least = 2.5 + plans["speed_mps"]
    in_right_lane = (plans["lane_number"] == 0) & (plans["route_position_m"] < 400.0)
    short = plans[in_right_lane & (beside < least)]
    assert len(short) > 100
    assert (short["rule"] == Rule.STRAIGHT.value).mean() > 0.98  # the recorded gaps are one step younger


def test_the_lane_change_is_carried_out_before_the_zebra(plans: pd.DataFrame) -> None:
    changing = plans["manoeuvre"] == Manoeuvre.CHANGE_LEFT.value
    assert changing.any()
    first = plans[changing].iloc[0]
    assert first["rule"] == Rule.LANE_CHANGE.value
    assert first["lane_number"] == 0
    assert plans["lane_number"].max() == 1
    # Beyond the slow column the ego drives freely again, and never stood.
    assert plans["speed_mps"][plans["lane_number"] == 1].max() > 12.0
    assert plans["speed_mps"].min() > 3.0
    assert (plans["route_position_m"][changing] < ZEBRA_BEGINS_M).all()
