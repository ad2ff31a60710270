"""The step, on a tiny world."""

from __future__ import annotations

import gc
import subprocess
import sys

import pytest

from controllers.interface import Decision, Perception, Plan
from cosim.errors import SimulationError
from cosim.step import loop
from cosim.step.loop import LoopTimes, ToWorld
from cosim.step.world import Snapshot
from tests.cosim.step.tiny_world import SteadyDriver, TinyWorld


class Diary:
    """Keeps what the loop tells."""

    def __init__(self) -> None:
        self.entries: list[tuple[str, str, float]] = []

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        assert compute_s >= 0.0
        self.entries.append(("plan", perception.ego.name, perception.ego.time))

    def stepped(self, snapshot: Snapshot) -> None:
        self.entries.append(("step", "", snapshot.time))


def test_every_ego_plans_before_the_world_moves_and_steps_without_plans_are_recorded_too() -> None:
    world, diary = TinyWorld(("a", "b"), steps=3, step=0.5), Diary()
    driver = SteadyDriver()
    times = loop.run(world, {"a": driver, "b": driver}, diary)
    assert diary.entries == [
        ("plan", "a", 0.0),
        ("plan", "b", 0.0),
        ("step", "", 0.5),
        ("step", "", 1.0),
        ("plan", "a", 1.0),
        ("plan", "b", 1.0),
        ("step", "", 1.5),
    ]
    assert times.steps == 3
    assert times.control > 0.0
    assert times.world > 0.0


def test_a_command_goes_on_until_the_next_plan() -> None:
    world = TinyWorld(steps=4, step=0.5)
    loop.run(world, {"ego": SteadyDriver(acceleration=2.0)}, Diary())
    assert world.speed["ego"] == pytest.approx(10.0 + 4 * 0.5 * 2.0)


def test_the_time_used_so_far_is_kept_when_the_world_breaks() -> None:
    times = LoopTimes()
    with pytest.raises(SimulationError, match="the road broke"):
        loop.run(TinyWorld(steps=9, breaks_at=4), {"ego": SteadyDriver()}, Diary(), times)
    assert times.steps == 4


def test_an_ego_that_nobody_drives_ends_the_run_by_name() -> None:
    with pytest.raises(SimulationError, match="nobody drives ego 'ego'"):
        loop.run(TinyWorld(), {}, Diary())


@pytest.mark.parametrize("wrong", [ZeroDivisionError("no speed\nat all"), SystemExit("no speed at all")])
def test_a_controller_that_raises_ends_the_run_by_name_and_time(wrong: BaseException) -> None:
    class Broken(SteadyDriver):
        def plan(self, perception: Perception, decision: Decision) -> Plan:
            raise wrong

    expected = r"controller of ego 'ego' failed at 0.00 s: (ZeroDivisionError|SystemExit): no speed at all"
    with pytest.raises(SimulationError, match=expected):
        loop.run(TinyWorld(), {"ego": Broken()}, Diary())


def test_a_command_that_is_not_a_number_ends_the_run() -> None:
    with pytest.raises(SimulationError, match="not a finite number"):
        loop.run(TinyWorld(), {"ego": SteadyDriver(acceleration=float("nan"))}, Diary())


def test_importing_the_step_loads_no_simulator() -> None:
    code = "import sys, cosim.step.loop, cosim.recording.recorder; "
    code += "sys.exit(bool({'libsumo', 'traci'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_garbage_is_looked_for_seldom_and_as_before_after_a_run_also_after_one_that_failed() -> None:
    before, during = gc.get_threshold(), list[int]()
    world = TinyWorld(("a",), steps=2, step=0.5)
    loop.run(
        world, {"a": SteadyDriver()}, Diary(), after_step=lambda time: during.append(gc.get_threshold()[0])
    )
    assert min(during) > before[0]
    assert gc.get_threshold() == before
    with pytest.raises(SimulationError):
        loop.run(TinyWorld(("a",), steps=2, step=0.5), {}, Diary())
    assert gc.get_threshold() == before
