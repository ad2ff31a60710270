"""Arithmetic gives the same compiled as it stands, on drawn arguments and on whole drives."""

from __future__ import annotations

import inspect
import pkgutil
import types
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import pytest

from controllers import catalog, numerics
from controllers.interface import FloatArray
from controllers.mpc.horizon import growing_grid
from controllers.mpc.lateral import LateralProgram, SteeringTask, SteeringWeights
from controllers.mpc.longitudinal import LongitudinalProgram, SpeedLimits, SpeedTask, SpeedWeights
from controllers.numerics import (
    last_plan,
    passing_classes,
    position_bounds,
    road_speeds,
    speed_program,
    vehicles_ahead,
)
from controllers.numerics.compiling import IN_LOOPS, check_compiler, code_of
from cosim.toy_world import ToyCrossing, ToyRoad, walk
from tests.controllers.toy_runs import ride

MODULES = [name for _, name, _ in pkgutil.iter_modules(numerics.__path__) if name != "compiling"]
N = 12
TIMES = np.cumsum(growing_grid(N, 0.1, 0.6))
Draw = np.random.Generator


def _same(module: types.ModuleType, name: str, *arguments: Any) -> None:
    """Call a function in both ways and compare what it returns."""
    plain = getattr(module, name)(*arguments)
    compiled = getattr(code_of(module, True), name)(*arguments)
    assert isinstance(compiled, tuple) == isinstance(plain, tuple)
    pairs = zip(plain, compiled, strict=True) if isinstance(plain, tuple) else [(plain, compiled)]
    for one, other in pairs:
        np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-12)


def _vehicles(draw: Draw) -> vehicles_ahead.Vehicles:
    n = int(draw.integers(0, 7))
    length = draw.uniform(3.0, 12.0, n)
    return vehicles_ahead.Vehicles(
        draw.uniform(-20.0, 60.0, n),
        draw.uniform(-5.0, 5.0, n),
        draw.uniform(-5.0, 15.0, n),
        draw.choice([0.0, 0.1, -0.8, 1.2], n),
        draw.uniform(-8.0, 3.0, n),
        draw.choice([0.0, 0.05, 1.5, 3.1], n),
        length,
        draw.uniform(1.6, 2.6, n),
    )


def _blockade(draw: Draw) -> None:
    centres = np.array([-3.2, 0.0, 3.2])
    _same(vehicles_ahead, "blockade", _vehicles(draw), 3.55, centres, -1.2, 1.2, TIMES)


def _footprints(draw: Draw) -> None:
    _same(vehicles_ahead, "footprints", _vehicles(draw))


def _reference_speeds(draw: Draw) -> None:
    count, limits = int(draw.integers(0, 40)), int(draw.integers(0, 4))
    curvature = draw.uniform(-0.05, 0.05, count) * draw.integers(0, 2, count)
    limit_along = np.sort(draw.uniform(-10.0, 80.0, limits))
    positions = np.cumsum(draw.uniform(-0.2, 3.0, N))
    demands = np.array([[2.0, 1.5], [3.0, 2.0]])
    limit = draw.uniform(5.0, 20.0, limits)
    _same(road_speeds, "reference_speeds", positions, curvature, 2.0, limit_along, limit, demands)


def _people(draw: Draw) -> tuple[FloatArray, ...]:
    n = int(draw.integers(1, 8))
    enter = np.sort(draw.uniform(0.0, 4.0, n) * draw.integers(0, 2, n))
    leave = np.where(draw.random(n) < 0.2, np.inf, enter + draw.uniform(0.1, 4.0, n))
    line = np.where(draw.random(n) < 0.3, np.inf, draw.uniform(-2.0, 30.0, n))
    return enter, leave, line, draw.uniform(0.0, 40.0, n), draw.uniform(-1.5, 1.5, n)


def _class_bounds(draw: Draw) -> None:
    enter, leave, line, along, speed = _people(draw)
    reach, driven = draw.uniform(1.0, 2.0, len(enter)), draw.uniform(0.0, 14.0, N)
    _same(
        passing_classes,
        "straight_class_bounds",
        *(enter, leave, line, along, speed, 3.0, reach, TIMES, driven, 3.55, 0.95),
    )


def _overlap(draw: Draw) -> None:
    n = int(draw.integers(0, 8))
    speed = draw.choice([0.0, -1.2, 1.4], n)
    low = draw.uniform(-3.0, -1.0, n)
    _same(passing_classes, "overlap", draw.uniform(-6.0, 6.0, n), speed, low, low + 3.0)


def _by_entry(draw: Draw) -> None:
    n = int(draw.integers(0, 8))
    enter = draw.choice([0.0, 1.0, 2.5, np.inf], n)
    arguments = draw.uniform(-5.0, 30.0, n), np.full(n, 0.3), draw.random(n) < 0.8, enter, 5.0, 0.95
    _same(passing_classes, "by_entry", *arguments)


def _shortfalls(draw: Draw) -> None:
    lower = np.where(draw.random((4, N)) < 0.5, -np.inf, draw.uniform(0.0, 60.0, (4, N)))
    upper = np.where(draw.random((4, N)) < 0.5, np.inf, draw.uniform(0.0, 60.0, (4, N)))
    largest = np.where(draw.random(N) < 0.5, np.inf, draw.uniform(0.0, 60.0, N))
    wanted = draw.uniform(2.0, 14.0, N)
    _same(passing_classes, "shortfalls", lower, upper, largest, TIMES, 9.0, wanted, 2.2, 3.0)


def _position_bounds(draw: Draw) -> None:
    rear = draw.uniform(3.0, 60.0) + 8.0 * TIMES if draw.random() < 0.7 else np.full(N, np.inf)
    line = draw.choice([np.inf, 2.0, 30.0])
    _same(position_bounds, "position_bounds", rear, rear + 3.0, rear, line, 3.55, 2.5, 11.0, TIMES)


def _last_plan(draw: Draw) -> None:
    speed = draw.uniform(0.0, 14.0, N)
    position = np.cumsum(speed * np.diff(TIMES, prepend=0.0))
    curvature = draw.uniform(-0.05, 0.05, int(draw.integers(0, 20)))
    _same(last_plan, "moved", TIMES, position, speed, float(draw.uniform(0.0, 1.4)))
    _same(last_plan, "sampled", TIMES, 0.4, draw.normal(size=N), -0.01, draw.normal(size=N), 0.05, 0.6)
    _same(last_plan, "in_intervals", position, 5.0, speed, curvature, 2.0)


def _departs(draw: Draw) -> None:
    expected = draw.uniform(0.0, 14.0, N)
    stoppable = np.where(draw.random(N) < 0.7, np.inf, 30.0)
    _same(speed_program, "departs", expected, expected + draw.normal(size=N) * 0.2, stoppable)


ARGUMENTS: tuple[Callable[[Draw], None], ...] = (
    _blockade,
    _footprints,
    _reference_speeds,
    _class_bounds,
    _overlap,
    _by_entry,
    _shortfalls,
    _position_bounds,
    _last_plan,
    _departs,
)


@pytest.mark.parametrize("drawn", ARGUMENTS, ids=lambda function: function.__name__.strip("_"))
def test_functions_give_the_same_compiled(drawn: Callable[[Draw], None]) -> None:
    pytest.importorskip("numba")
    for seed in range(60):
        drawn(np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(10))
def test_programs_are_written_the_same_compiled(seed: int) -> None:
    pytest.importorskip("numba")
    draw = np.random.default_rng(seed)
    inf = np.inf
    speed_task = SpeedTask(
        speed=float(draw.uniform(0.0, 14.0)),
        acceleration=float(draw.uniform(-6.0, 2.0)),
        command=float(draw.uniform(-6.0, 2.0)),
        reference=draw.uniform(2.0, 14.0, N),
        expected=draw.uniform(0.0, 14.0, N),
        upper=np.where(draw.random(N) < 0.5, inf, draw.uniform(0.0, 50.0, N)),
        lower=np.where(draw.random(N) < 0.5, -inf, draw.uniform(0.0, 50.0, N)),
        stoppable=np.where(draw.random(N) < 0.5, inf, draw.uniform(0.0, 50.0, N)),
        headway=np.where(draw.random(N) < 0.5, inf, draw.uniform(0.0, 50.0, N)),
        ceiling=draw.uniform(2.0, 20.0, N) if draw.random() < 0.5 else None,
    )
    steering_task = SteeringTask(
        *(0.2, -0.03, 0.01, 0.02, draw.uniform(0.5, 14.0, N), draw.uniform(-0.02, 0.02, N)),
        *(np.full(N, 0.3), np.full(N, -0.7), np.full(N, 0.7)),
    )
    for plain, compiled, task in (
        (*(_speed(how) for how in (False, True)), speed_task),
        (*(_steering(how) for how in (False, True)), steering_task),
    ):
        one, other = plain.solve(task), compiled.solve(task)
        for name in ("P", "q", "G", "h", "lower", "upper"):
            written, again = getattr(plain.program, name), getattr(compiled.program, name)
            np.testing.assert_allclose(again, written, rtol=1e-11, atol=1e-11)
        np.testing.assert_allclose(other.inputs, one.inputs, atol=1e-7)
        assert other.cost == pytest.approx(one.cost, rel=1e-9, abs=1e-9)


def _speed(compiled: bool) -> Any:
    dt = growing_grid(N, 0.1, 0.6)
    return LongitudinalProgram(dt, 0.3, SpeedWeights(), SpeedLimits(), compiled=compiled)


def _steering(compiled: bool) -> Any:
    dt = growing_grid(N, 0.1, 0.6)
    return LateralProgram(dt, 0.1, 2.6, 3.55, 0.6, 0.6, SteeringWeights(), compiled=compiled)


def test_a_whole_drive_is_the_same_compiled() -> None:
    pytest.importorskip("numba")
    pytest.importorskip("daqp")
    people = [walk(62.0 + 0.4 * i, -6.0 + 3.0 * i, 0.0, (-1.0) ** i * (1.1 + 0.1 * i)) for i in range(5)]
    cars = [walk(45.0, 0.0, 9.0, 0.0), walk(5.0, 3.5, 11.0, -0.2)]
    road = ToyRoad(lanes=2, crossings=(ToyCrossing(60.0),))
    drives = [
        ride(road, people, vehicles=cars, duration=12.0, parameters={"solver": "daqp", "compiled": compiled})
        for compiled in (False, True)
    ]
    plain, compiled = drives
    assert plain.track.shape[1] > 100
    np.testing.assert_allclose(compiled.track, plain.track, atol=1e-6)


def _compiled_functions(module: types.ModuleType) -> dict[str, types.FunctionType]:
    """Return the texts that Numba may get to see, by the names they are called by."""
    texts = {
        name: getattr(module, name + IN_LOOPS, function)
        for name, function in inspect.getmembers(module, inspect.isfunction)
        if function.__module__ == module.__name__ and not name.endswith(IN_LOOPS)
    }
    every = inspect.getmembers(module, inspect.isfunction)
    called = {used for _, function in every for used in function.__code__.co_names}
    seen = [name for name in texts if name not in called]  # what other modules call
    for name in seen:
        seen += [used for used in texts[name].__code__.co_names if used in texts and used not in seen]
    return {name: texts[name] for name in seen}


@pytest.mark.parametrize("name", MODULES)
def test_a_module_of_arithmetic_uses_nothing_of_others(name: str) -> None:
    """Numba's cache would not notice that a function or constant of another file has changed."""
    module = import_module(f"controllers.numerics.{name}")
    functions = _compiled_functions(module)
    assert functions
    for function in functions.values():
        for used in function.__code__.co_names:
            value = vars(module).get(used)
            own = value is np or value is None or isinstance(value, int | float)
            own = own or getattr(value, "__module__", "") == module.__name__
            assert own, f"{name}.{function.__name__} uses {used}"


def test_what_has_no_place_for_its_machine_code_is_compiled_all_the_same() -> None:
    pytest.importorskip("numba")
    module = types.ModuleType("nowhere")
    exec(compile("def twice(x):\n    return x + x\n", "<nowhere>", "exec"), module.__dict__)
    assert code_of(module, True).twice(2.0) == 4.0


def test_without_numba_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"compiled needs Numba.*sumo-cosim\[fast\]"):
        check_compiler()
    with pytest.raises(ValueError, match="compiled needs Numba"):
        catalog.build("vo_mpc", seed=1, compiled=True)
