"""What every controller that solves programs promises when its solver is no good: it says so, and stops in time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from controllers import catalog
from cosim.step.loop import run
from cosim.step.toy_road import ToyCrossing, ToyPedestrian, ToyRoad, walk
from cosim.step.toy_world import ToyWorld
from tests.controllers.faulty_solvers import FAULTS, Answer, installed, lies
from tests.controllers.toy_runs import Ride

SOLVING = [name for name in catalog.names() if "solver" in catalog.parameters(name)]
"""Whoever solves programs lets the user choose the solver."""
VARIANTS: dict[str, tuple[dict[str, Any], ...]] = {"vo_mpc": ({}, {"cone": "vo", "truncation_s": 3.0})}
"""Parameters with which a controller solves other programs; nothing for the defaults alone."""
CASES = [
    pytest.param(name, variant, id="-".join([name, *map(str, variant.values())]))
    for name in SOLVING
    for variant in VARIANTS.get(name, ({},))
]
WITH_FAULTS = [
    pytest.param(
        *case.values,
        fault,
        id=f"{fault.__name__}-{case.id}",
        marks=() if fault is lies or case.id == "vo_mpc" else pytest.mark.slow,
    )
    for fault in FAULTS
    for case in CASES
]
"""Everybody has a solver that lies, and ``vo_mpc`` all of them: controllers get the same answer of any fault."""


def test_there_are_controllers_that_solve_programs() -> None:
    assert "vo_mpc" in SOLVING
    assert set(VARIANTS) <= set(SOLVING)


@pytest.mark.parametrize(("name", "variant", "fault"), WITH_FAULTS)
def test_a_faulty_solver_makes_unsolved_steps_and_the_fallback_touches_nobody(
    name: str, variant: dict[str, Any], fault: Answer, monkeypatch: pytest.MonkeyPatch
) -> None:
    solver = installed(monkeypatch, "faulty", fault)
    crossing = ToyCrossing(45.0)
    walkers = [walk(46.0, -6.0, 0.0, 1.3, stop=5.0), walk(47.5, 8.0, 0.0, -1.2)]
    people = [ToyPedestrian(f"p{i}", motion) for i, motion in enumerate(walkers)]
    world = ToyWorld(ToyRoad(crossings=(crossing,)), people, speed=11.0, duration=9.0)
    record = Ride()
    run(world, {"ego": catalog.build(name, solver=solver, **variant)}, record)
    solves = [plan.solves for plan in record.plans if plan.solves is not None]
    assert sum(one.programs for one in solves) > 0
    assert all(one.unsolved == one.programs for one in solves)
    tried = [plan for plan in record.plans if plan.solves is not None and plan.solves.programs]
    assert not any(plan.solved for plan in tried)
    assert all(plan.status.startswith("fallback") for plan in tried)
    assert record.clearance() > 0.0
    assert np.isfinite(record.track).all()
