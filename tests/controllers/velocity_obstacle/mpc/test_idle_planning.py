"""Planning less often on an empty road, and at every step as soon as somebody is near."""

from __future__ import annotations

import numpy as np
import pytest

from controllers import catalog
from cosim.step.toy_road import ToyCrossing, ToyRoad, walk
from tests.controllers.toy_runs import Ride, ride


def _planned(record: Ride) -> int:
    """Return how many plans were made; a rest has no horizon."""
    return sum(len(plan.times) > 0 for plan in record.plans)


def test_on_an_empty_road_every_fifth_step_is_planned_and_the_ego_drives_almost_the_same() -> None:
    often = ride(ToyRoad(), speed=5.0, duration=10.0)
    seldom = ride(ToyRoad(), speed=5.0, duration=10.0, parameters={"idle_interval_s": 0.5})
    assert _planned(often) == len(often.plans)
    assert _planned(seldom) == pytest.approx(len(often.plans) / 5, abs=2)
    # Measured: 0.2 m behind after 112 m, while it speeds up from 5 to 13.9 m/s.
    assert np.abs(seldom.track[0] - often.track[0]).max() < 0.3
    assert np.abs(seldom.track[2] - often.track[2]).max() < 0.1


def test_with_a_crossing_in_view_nothing_changes() -> None:
    road, people = ToyRoad(crossings=(ToyCrossing(60.0),)), [walk(62.0, -6.0, 0.0, 1.3)]
    often = ride(road, people, duration=8.0)
    seldom = ride(road, people, duration=8.0, parameters={"idle_interval_s": 0.5})
    before = often.track[0] < 62.0
    assert before.sum() > 40
    assert np.array_equal(seldom.track[:, before], often.track[:, before])


def test_who_walks_onto_an_empty_road_is_planned_for_from_that_step_on() -> None:
    # To the side nobody is out of sight; the pedestrian comes from behind what the ego looks at.
    people = [walk(130.0, -4.0, -12.0, 0.4)]
    record = ride(ToyRoad(), people, speed=3.0, duration=9.0, parameters={"idle_interval_s": 0.5})
    planned = np.array([len(plan.times) > 0 for plan in record.plans])
    gap = np.array([s.persons.x[0] - s.egos[0].x for s in record.snapshots])
    near = (gap < 30.0) & (gap > 0.0)
    assert near[:-1].any()
    assert planned[1:][near[:-1]].all()
    assert not planned[1:][gap[:-1] > 100.0].all()


@pytest.mark.parametrize("interval", [-0.1, 0.6, float("nan")])
def test_an_interval_that_commands_do_not_last_for_is_refused(interval: float) -> None:
    with pytest.raises(ValueError, match="idle_interval_s"):
        catalog.build("vo_mpc", idle_interval_s=interval)
