"""Roadside units and the radio: rate, latency, losses, time stamps, several units."""

from __future__ import annotations

import numpy as np
import pytest

from cosim.sensing import catalog
from cosim.sensing.interface import Belief, Sensing, Site, State
from tests.cosim.sensing.scenes import SITE, Walker, exactly, off, scene

STANDING: Walker = ("s", 30.0, -3.0, 0.0, 0.0)
WALKER: Walker = ("w", 30.0, -3.0, 0.3, 1.2)


def _looks(model: Sensing, walkers: list[Walker], steps: int, seed: int = 1) -> list[Belief]:
    sensor = model.sensor(SITE, seed, "ego")
    return [sensor.look(scene(walkers, 0.1 * k)) for k in range(steps)]


def test_without_latency_losses_and_noise_it_is_perfect_within_its_range() -> None:
    walkers = [WALKER, ("far", 80.0, 0.0, 0.0, 0.0), ("near", 60.0, 4.0, -1.0, 0.0)]
    for k, belief in enumerate(_looks(exactly("roadside", unit_range_m=40.0), walkers, 20)):
        true = scene(walkers, 0.1 * k)
        within = np.hypot(*(true.position - [30.0, -4.0]).T) <= 40.0
        assert belief.told.tolist() == within.tolist() == [True, False, True]
        assert (belief.position[within] == true.position[within]).all()
        assert (belief.velocity[within] == true.velocity[within]).all()
        assert (belief.age[within] == 0.0).all()
        assert belief.state.tolist() == [State.VISIBLE, State.OUT_OF_RANGE, State.VISIBLE]


def test_what_is_late_is_extrapolated() -> None:
    beliefs = _looks(exactly("roadside", latency_ms=300.0), [WALKER], 12)
    assert [bool(one.told[0]) for one in beliefs] == [False] * 3 + [True] * 9
    assert [int(one.state[0]) for one in beliefs] == [State.LATE] * 12
    assert beliefs[11].age[0] == pytest.approx(0.3)
    # The pedestrian walks straight on, so the extrapolation is right.
    assert off(beliefs[11].position, scene([WALKER], 1.1).position) < 1e-9


def test_somebody_who_turned_since_the_message_is_believed_to_walk_on() -> None:
    sensor = exactly("roadside", latency_ms=500.0).sensor(SITE, 1, "ego")
    for k in range(11):
        turned: Walker = ("w", 30.0, -3.0, 0.0, 1.0) if k <= 5 else ("w", 30.0, -2.0, 0.0, -1.0)
        belief = sensor.look(scene([turned], 0.1 * k))
    assert belief.age[0] == pytest.approx(0.5)
    assert belief.position[0].tolist() == pytest.approx([30.0, -2.0])
    assert belief.velocity[0].tolist() == [0.0, 1.0]


def test_messages_come_at_their_rate() -> None:
    beliefs = _looks(exactly("roadside", message_rate_hz=2.0), [WALKER], 20)
    ages = [one.age[0] for one in beliefs]
    assert ages == pytest.approx([0.1 * (k % 5) for k in range(20)])


def test_lost_messages_never_arrive() -> None:
    beliefs = _looks(exactly("roadside", loss_probability=0.4, message_hold_s=0.3), [STANDING], 2000)
    states = np.array([one.state[0] for one in beliefs])
    # The standard deviation of the share is 0.011.
    assert (states == State.LOST).mean() == pytest.approx(0.4, abs=0.05)
    told = np.array([one.told[0] for one in beliefs])
    # Not told: the newest four messages were lost, 0.4^4 = 2.6 %.
    assert 1.0 - told.mean() == pytest.approx(0.4**4, abs=0.02)
    assert not _looks(exactly("roadside", loss_probability=1.0), [STANDING], 30)[-1].told.any()


def test_latency_is_spread_and_the_newest_measurement_counts() -> None:
    model = exactly("roadside", latency_ms=100.0, latency_jitter_ms=200.0)
    ages = np.array([one.age[0] for one in _looks(model, [STANDING], 500)[20:]])
    assert ages.min() >= 0.1 - 1e-9
    assert ages.max() > 0.25
    # A message that overtakes another makes the older one worthless: never does the age grow by more than
    # the time that has passed.
    assert np.diff(ages).max() < 0.1 + 1e-9


def test_of_several_units_the_newest_measurement_counts() -> None:
    model = exactly("roadside", units="30,-5 60,5", unit_range_m=20.0)
    walkers = [("first", 25.0, 0.0, 0.0, 0.0), ("both", 45.0, 0.0, 0.0, 0.0), ("second", 70.0, 0.0, 0.0, 0.0)]
    belief = _looks(model, walkers, 1)[0]
    assert belief.told.all()
    assert off(belief.position, scene(walkers).position) == 0.0


def test_a_unit_has_a_field_of_view_and_may_be_low() -> None:
    south: Walker = ("south", 40.0, -20.0, 0.0, 0.0)
    north: Walker = ("north", 40.0, 10.0, 0.0, 0.0)
    model = exactly("roadside", units="40,-5,90", unit_field_of_view_deg=120.0)
    assert _looks(model, [south, north], 1)[0].told.tolist() == [False, True]
    low = exactly("roadside", units="40,-5", unit_sees_over_vehicles=False)
    bus = [(46.0, 0.0, 0.0)]
    belief = low.sensor(SITE, 1, "ego").look(scene([north], 0.0, bus))
    assert belief.state.tolist() == [State.HIDDEN]
    high = exactly("roadside", units="40,-5").sensor(SITE, 1, "ego").look(scene([north], 0.0, bus))
    assert high.told.all()
    house = Site(SITE.crossings, SITE.lanes, np.array([[30.0, 3.0, 50.0, 3.0]]))
    behind = exactly("roadside", units="40,-5").sensor(house, 1, "ego").look(scene([north]))
    assert behind.state.tolist() == [State.HIDDEN]


def test_two_egos_are_told_of_the_same_measurement_and_lose_different_messages() -> None:
    noisy = catalog.build("roadside", {"latency_ms": 0, "unit_miss_probability": 0})
    beliefs = [noisy.sensor(SITE, 1, ego).look(scene([WALKER], ego=ego)) for ego in ("a", "b")]
    assert (beliefs[0].position == beliefs[1].position).all()
    model = exactly("roadside", loss_probability=0.5)
    lost = [
        [int(s.look(scene([WALKER], 0.1 * k, ego=ego)).state[0]) for k in range(60)]
        for ego in ("a", "b")
        for s in (model.sensor(SITE, 1, ego),)
    ]
    assert lost[0] != lost[1]


def test_an_ego_hides_people_from_a_low_unit_for_itself_too() -> None:
    low = exactly("roadside", units="2,-5", unit_sees_over_vehicles=False)
    across: Walker = ("across", 2.0, 5.0, 0.0, 0.0)
    assert low.sensor(SITE, 1, "ego").look(scene([across])).state.tolist() == [State.HIDDEN]
    assert low.sensor(SITE, 1, "ego").look(scene([across], x=10.0)).told.all()
    high = exactly("roadside", units="2,-5")
    assert high.sensor(SITE, 1, "ego").look(scene([across])).told.all()


@pytest.mark.parametrize("rate", [1.0, 3.0, 10.0])
def test_an_ego_that_comes_between_two_messages_hears_the_next_one(rate: float) -> None:
    model = exactly("roadside", message_rate_hz=rate, message_hold_s=5.0)
    early, late = model.sensor(SITE, 1, "early"), model.sensor(SITE, 1, "late")
    for k in range(13):
        early.look(scene([WALKER], 0.1 * k, ego="early"))
    heard = []
    for k in range(13, 40):
        known, new = early.look(scene([WALKER], 0.1 * k)), late.look(scene([WALKER], 0.1 * k))
        heard.append(bool(new.told[0]))
        assert not new.told[0] or new.age[0] == known.age[0]
    # The next messages are those of 2.0, 1.4 (4 / 3 at the next look) and 1.3 s.
    assert heard.index(True) == {1.0: 7, 3.0: 1, 10.0: 0}[rate]
    assert all(heard[heard.index(True) :])


@pytest.mark.parametrize("units", ["500,400", "0,0 9999,0"])
def test_a_unit_outside_the_network_is_refused(units: str) -> None:
    with pytest.raises(ValueError, match="outside the network"):
        catalog.build("roadside", {"units": units}).sensor(SITE, 1, "ego")


def test_units_at_crossings_need_crossings() -> None:
    nowhere = Site({}, SITE.lanes, SITE.walls)
    with pytest.raises(ValueError, match="the network has none; expected places"):
        catalog.build("roadside", {}).sensor(nowhere, 1, "ego")
