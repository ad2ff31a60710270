"""The ego's own sensor: what hides, when a track is confirmed, how long it lasts, how good it is."""

from __future__ import annotations

import numpy as np
import pytest

from cosim.sensing.interface import Belief, Sensing, State
from tests.cosim.sensing.scenes import SITE, Walker, exactly, off, scene

CHILD: Walker = ("child", 20.0, -6.0, 0.0, 1.5)
BUS = (19.0, -3.0, 0.0)
"""Its front is at x = 19 m, its left side at y = -1.75 m."""


def _looks(model: Sensing, walkers: list[Walker], steps: int, **how: object) -> list[Belief]:
    sensor = model.sensor(SITE, 1, "ego")
    return [sensor.look(scene(walkers, 0.1 * k, **how)) for k in range(steps)]  # type: ignore[arg-type]


def test_the_bus_hides_the_child_until_it_comes_out_before_it() -> None:
    beliefs = _looks(exactly("onboard"), [CHILD], 40, cars=[BUS])
    # The eye is 1.75 m ahead of the rear axle; past the bus's front left corner the line to x = 20 m is at
    # y = -1.75 · 18.25 / 17.25 = -1.85 m, and the child's edge is there 0.25 m before its middle.
    out = [k for k in range(40) if -6.0 + 0.15 * k > -1.851 - 0.25]
    assert [k for k, one in enumerate(beliefs) if one.told[0]] == out
    assert {one.state[0] for one in beliefs[: out[0]]} == {State.HIDDEN}
    assert off(beliefs[-1].position, scene([CHILD], 3.9).position) < 1e-9
    assert off(beliefs[-1].velocity, scene([CHILD], 3.9).velocity) < 1e-9


def test_where_the_sensor_sits_decides_what_it_sees() -> None:
    near: Walker = ("near", 2.0, 2.0, 0.0, 0.0)
    narrow = exactly("onboard", field_of_view_deg=60.0, mount_behind_front_m=3.0)
    ahead = exactly("onboard", field_of_view_deg=60.0, mount_behind_front_m=0.0)
    assert not _looks(narrow, [near], 1)[0].told[0]
    assert not _looks(ahead, [near], 1)[0].told[0]
    assert _looks(exactly("onboard"), [near], 1)[0].told[0]
    # From 1 m further left the line to (6, 4) keeps within 30 degrees.
    beside: Walker = ("beside", 6.0, 3.3, 0.0, 0.0)
    assert not _looks(narrow, [beside], 1)[0].told[0]
    shifted = exactly("onboard", field_of_view_deg=60.0, mount_behind_front_m=3.0, mount_left_m=1.0)
    assert _looks(shifted, [beside], 1)[0].told[0]


def test_a_track_is_confirmed_by_so_many_detections_within_so_many_looks() -> None:
    model = exactly("onboard", confirm_hits=3, confirm_looks=5)
    assert [bool(one.told[0]) for one in _looks(model, [CHILD], 5)] == [False, False, True, True, True]
    sensor = model.sensor(SITE, 1, "ego")
    hidden = {1, 3, 4}  # the third detection of five looks is the sixth look
    told = [
        bool(sensor.look(scene([CHILD], 0.1 * k, [(15.0, 5.0, 1.57)] if k in hidden else [])).told[0])
        for k in range(7)
    ]
    assert told == [False, False, False, False, False, False, True]


def test_a_lost_track_goes_on_at_its_velocity_and_ends() -> None:
    model = exactly("onboard", hold_s=0.5)
    sensor = model.sensor(SITE, 1, "ego")
    walker: Walker = ("w", 20.0, -6.0, 0.4, 1.2)
    wall = [(10.0, 0.0, 1.57)]
    for k in range(5):
        sensor.look(scene([walker], 0.1 * k))
    after = [sensor.look(scene([walker], 0.1 * k, [*wall, (10.0, 6.0, 1.57)])) for k in range(5, 12)]
    assert {int(one.state[0]) for one in after} == {State.HIDDEN}
    assert [bool(one.told[0]) for one in after] == [True] * 5 + [False] * 2
    assert [one.age[0] for one in after[:5]] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5])
    assert off(after[4].position, scene([walker], 0.9).position) < 1e-9
    assert (np.diff([one.uncertainty[0] for one in after[:5]]) > 0.0).all()
    assert np.isnan(after[5].position).all()
    assert np.isnan(after[5].age[0])
    assert np.isnan(after[5].uncertainty[0])


def test_the_filter_is_better_than_the_measurements_and_knows_how_good_it_is() -> None:
    noisy = exactly("onboard", position_noise_m=0.5, velocity_noise_mps=0.5)
    walkers = [(f"w{k}", 20.0 + 0.1 * k, -10.0, 0.2, 1.0) for k in range(200)]
    last = _looks(noisy, walkers, 60)[-1]
    errors = last.position - scene(walkers, 5.9).position
    deviation = float(last.uncertainty[0])
    assert deviation < 0.25
    # Nobody here changes velocity, which the filter allows for; it is not overconfident.
    assert 0.5 * deviation < errors.std() < 1.05 * deviation
    assert abs(errors.mean()) < 0.05


def test_so_many_detections_are_missed() -> None:
    model = exactly("onboard", miss_probability=0.3)
    walkers = [(f"w{k}", 20.0 + 0.1 * k, -10.0, 0.0, 0.0) for k in range(100)]
    states = np.array([one.state for one in _looks(model, walkers, 50)])
    # 5000 draws; the standard deviation of the share is 0.0065.
    assert (states == State.MISSED).mean() == pytest.approx(0.3, abs=0.03)


def test_noise_depends_on_person_and_time_and_not_on_what_else_there_is() -> None:
    model = exactly("onboard", position_noise_m=0.4)
    child = scene([CHILD], 0.7)
    alone = model.sensor(SITE, 5, "ego").look(child).position - child.position
    other = ("other", 10.0, 3.0, 0.0, 0.0)
    sensor = model.sensor(SITE, 5, "ego")
    for k in range(7):
        sensor.look(scene([other], 0.1 * k))
    both = scene([other, CHILD], 0.7, x=5.0)
    assert off((sensor.look(both).position - both.position)[1:], alone) < 1e-12
    for seed, ego in ((6, "ego"), (5, "another")):
        assert off(model.sensor(SITE, seed, ego).look(child).position - child.position, alone) > 1e-3
