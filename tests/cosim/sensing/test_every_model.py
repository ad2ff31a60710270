"""What every sensing model promises, whoever adds one, with every controller."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from controllers import catalog as controllers
from controllers.interface import CrossingKind, Decision, Perception, Plan
from cosim.sensing import catalog
from cosim.sensing.interface import Belief, Scene, Sensed, State
from cosim.step import loop
from cosim.step.loop import ToWorld
from cosim.step.toy_road import ToyCrossing, ToyPedestrian, ToyRoad, ToyVehicle, walk
from cosim.step.toy_world import ToyWorld
from cosim.step.world import Snapshot
from tests.controllers.brief_searches import BRIEF_SEARCHES
from tests.cosim.sensing.scenes import SITE, Walker, exactly, scene

every_model = pytest.mark.parametrize("model", catalog.names())
TOGETHER = {"fused", "aeb", "vo_mpc"}
"""In the quick tests every controller drives with the model of both sensors, and these drive with every model."""
WALKERS: list[Walker] = [
    ("child", 20.0, -6.0, 0.0, 1.5),
    ("walker", 30.0, 5.0, 0.2, -1.2),
    ("far", 75.0, 5.0, 0.0, 0.0),
    ("behind", -15.0, 4.0, 1.0, 0.0),
]


@dataclass
class _Kept:
    """What was perceived, planned and true in a run on the toy road."""

    perceptions: list[Perception] = field(default_factory=list)
    plans: list[Plan] = field(default_factory=list)
    snapshots: list[Snapshot] = field(default_factory=list)

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        self.perceptions.append(perception)
        self.plans.append(plan)

    def stepped(self, snapshot: Snapshot) -> None:
        self.snapshots.append(snapshot)

    def sensed(self) -> list[Sensed]:
        return [one for snapshot in self.snapshots for one in snapshot.sensed or ()]


def _drive(model: str, controller: str, seed: int = 1, duration: float = 2.5) -> _Kept:
    world = ToyWorld(
        ToyRoad(lanes=2, crossings=(ToyCrossing(45.0, kind=CrossingKind.ZEBRA),)),
        [
            ToyPedestrian("crosses", walk(47.0, -3.0, 0.0, 1.3)),
            ToyPedestrian("waits", walk(46.0, 6.0, 0.0, 0.0)),
            ToyPedestrian("hidden", walk(25.0, -3.9, 0.0, 0.8, start=1.0)),
        ],
        [ToyVehicle("bus", walk(23.0, -2.8, 0.0, 0.0), 9.0, 2.2)],
        speed=8.0,
        duration=duration,
        sensing=catalog.build(model, {}),
        seed=seed,
    )
    kept = _Kept()
    loop.run(world, {"ego": controllers.build(controller, **BRIEF_SEARCHES.get(controller, {}))}, kept)
    return kept


@pytest.mark.parametrize(
    ("controller", "model"),
    [
        pytest.param(controller, model, marks=[] if TOGETHER & {controller, model} else [pytest.mark.slow])
        for controller in controllers.names()
        for model in catalog.names()
    ],
)
def test_every_controller_drives_with_it(model: str, controller: str) -> None:
    kept = _drive(model, controller, duration=1.5)
    assert len(kept.plans) == 15
    for plan in kept.plans:
        assert np.isfinite(plan.command.acceleration).all()
        assert np.isfinite(plan.command.steering).all()


@every_model
def test_perceptions_hold_finite_numbers_and_only_who_is_told(model: str) -> None:
    kept = _drive(model, "constant_speed")
    assert any(len(one.pedestrians) for one in kept.perceptions)
    told = [tuple(name for name, yes in zip(s.names, s.told, strict=True) if yes) for s in kept.sensed()]
    for index, perception in enumerate(kept.perceptions):
        seen = perception.pedestrians
        columns = (
            seen.along,
            seen.across,
            seen.along_speed,
            seen.across_speed,
            seen.radius,
            seen.uncertainty,
        )
        for values in columns:
            assert len(values) == len(seen)
            assert np.isfinite(values).all()
        assert (seen.uncertainty >= 0.0).all()
        assert len(seen.crossing) == len(seen.on_crossing) == len(seen.waiting) == len(seen)
        if model != catalog.PERFECT:
            assert seen.names == told[index]


@every_model
def test_what_is_true_does_not_depend_on_it(model: str) -> None:
    kept, known = _drive(model, "constant_speed"), _drive(catalog.PERFECT, "constant_speed")
    for one, other in zip(kept.snapshots, known.snapshots, strict=True):
        assert one.egos == other.egos
        for name in ("x", "y", "x_speed", "y_speed", "radius"):
            assert (getattr(one.persons, name) == getattr(other.persons, name)).all()


@every_model
def test_the_record_fits_to_what_was_believed(model: str) -> None:
    kept = _drive(model, "constant_speed")
    if model == catalog.PERFECT:
        assert all(snapshot.sensed is None for snapshot in kept.snapshots)
        return
    assert len(kept.sensed()) == len(kept.perceptions)
    states = {state.name.lower() for state in State}
    for sensed, perception, snapshot in zip(kept.sensed(), kept.perceptions, kept.snapshots, strict=True):
        assert sensed.time == perception.ego.time < snapshot.time
        assert set(sensed.state) <= states
        for values in (sensed.age, sensed.error, sensed.uncertainty):
            assert (np.isfinite(values) == sensed.told).all()
        assert (sensed.age[sensed.told] >= 0.0).all()


@every_model
def test_the_same_seed_gives_the_same_and_another_seed_something_else(model: str) -> None:
    runs = [_drive(model, "constant_speed", seed) for seed in (3, 3, 4)]
    along = [np.concatenate([one.pedestrians.along for one in run.perceptions]) for run in runs]
    np.testing.assert_array_equal(along[0], along[1])
    if model != catalog.PERFECT:
        assert len(along[0]) != len(along[2]) or (along[0] != along[2]).any()


@every_model
def test_looks_do_not_depend_on_other_egos_or_on_who_drives(model: str) -> None:
    made = catalog.build(model, {})
    alone = made.sensor(SITE, 1, "ego")
    first = [alone.look(scene(WALKERS, 0.1 * k)) for k in range(12)]
    one, other = made.sensor(SITE, 1, "ego"), made.sensor(SITE, 1, "other")
    for k in range(12):
        other.look(scene(WALKERS[:1], 0.1 * k, ego="other"))
        again = one.look(scene(WALKERS, 0.1 * k))
        _same(first[k], again)


@every_model
def test_noise_is_the_same_wherever_the_ego_is(model: str) -> None:
    """Of two egos that drive differently the errors are the same, where they measure the same person."""
    made = exactly(model, **_noise(model))
    errors = []
    for speed in (0.0, 5.0):
        sensor = made.sensor(SITE, 1, "ego")
        for k in range(10):
            true = scene(WALKERS[:2], 0.1 * k, x=0.1 * k * speed)
            belief = sensor.look(true)
            assert belief.told.all()
            errors.append(belief.position - true.position)
    np.testing.assert_allclose(errors[:10], errors[10:], atol=1e-9)
    assert model == catalog.PERFECT or np.abs(errors).max() > 0.05


def _noise(model: str) -> dict[str, float]:
    wanted = {"position_noise_m": 0.3, "unit_position_noise_m": 0.3}
    return {key: value for key, value in wanted.items() if key in catalog.parameters(model)}


@every_model
@pytest.mark.parametrize("count", [0, 1, 3])
def test_anybody_may_come_and_go(model: str, count: int) -> None:
    sensor = catalog.build(model, {}).sensor(SITE, 1, "ego")
    for k in range(30):
        present: list[Walker] = [(f"w{k // 4 + i}", 20.0 + i, 0.0, 0.0, 1.0) for i in range(count)]
        belief = sensor.look(scene(present, 0.1 * k))
        _assert_belief(belief, scene(present, 0.1 * k))


def _assert_belief(belief: Belief, true: Scene) -> None:
    count = len(true.names)
    assert belief.position.shape == belief.velocity.shape == (count, 2)
    for values in (belief.told, belief.uncertainty, belief.age, belief.state):
        assert values.shape == (count,)
    assert np.isfinite(belief.position[belief.told]).all()
    assert np.isfinite(belief.velocity[belief.told]).all()


@every_model
def test_it_tells_what_it_is_and_what_can_be_set(model: str) -> None:
    assert catalog.describe(model).endswith(".")
    made = catalog.build(model, catalog.parameters(model))
    assert catalog.values_of(made) == catalog.parameters(model)
    texts = {key: str(value) for key, value in catalog.parameters(model).items()}
    assert catalog.values_of(catalog.build(model, texts)) == catalog.parameters(model)


def test_both_sensors_together_are_at_least_as_certain_as_each() -> None:
    values = {"onboard": {"position_noise_m": 0.2}, "roadside": {"latency_ms": 200.0}}
    both = {**values["onboard"], **values["roadside"]}
    sensors = {
        name: catalog.build(name, values.get(name, both)).sensor(SITE, 1, "ego")
        for name in ("onboard", "roadside", "fused")
    }
    for k in range(25):
        bus = [(19.0, -3.0, 0.0)] if k < 15 else []
        beliefs = {name: one.look(scene(WALKERS, 0.1 * k, bus)) for name, one in sensors.items()}
        first, second, fused = (beliefs[name] for name in ("onboard", "roadside", "fused"))
        assert (fused.told == (first.told | second.told)).all()
        best = np.fmin(first.uncertainty, second.uncertainty)
        np.testing.assert_array_equal(fused.uncertainty, best)
        np.testing.assert_array_equal(fused.state, np.minimum(first.state, second.state))


def _same(one: Belief, other: Belief) -> None:
    for name in Belief.__slots__:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
