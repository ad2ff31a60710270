"""Time of a Gymnasium step against the same step of a run, and what fifty environments leave behind.

``python benchmarks/environment_overhead.py``; exit code 1 if a bar is missed. Needs the extra ``gym``.
"""

from __future__ import annotations

import gc
import os
import sys
from pathlib import Path
from statistics import median
from time import process_time

import gymnasium
import numpy as np

import cosim.gym
from controllers.interface import Decision, Perception, Plan
from controllers.outside.functions import FromFunction
from controllers.outside.handed_over import given
from controllers.outside.view import View
from cosim.running.compose import compose
from cosim.running.request import RunRequest
from cosim.step import loop
from cosim.step.loop import ToWorld
from cosim.step.world import Snapshot

OVERHEAD_BAR = 0.10
"""Largest share that the environment may add to the time of a step."""
LEAK_BAR_KIB = 200.0
"""Largest growth of memory per environment, after the first ones [KiB]."""
ROUNDS = 9
TIME_LIMIT_S = 40.0
SETTINGS = {"warmup_s": 30.0, "ego_count": 1, "pedestrians_per_hour": 600.0, "duration_s": 70.0}


class _Nothing:
    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None: ...

    def stepped(self, snapshot: Snapshot) -> None: ...


def towards(speed: float) -> float:
    return min(max(8.0 - speed, -3.0), 2.0)


def plain_step_s(seed: int, observing: bool) -> float:
    """Return the time of a step of a run without recording; starting is not counted [s].

    Parameters
    ----------
    seed
    observing
        Whether the controller makes the same observation for its policy as the environment does.
    """
    view = View()

    def policy(perception: Perception) -> float:
        seen = float(view.observe(perception)[0]) if observing else perception.ego.speed
        return towards(seen)

    controller = given(FromFunction(policy))
    settings = {key: repr(value) for key, value in SETTINGS.items()}
    composition = compose(RunRequest("midblock_zebra", controller, seed, settings))
    try:
        composition.world.sense()  # the warm-up
        began = process_time()
        times = loop.run(composition.world, composition.drivers, _Nothing())
        return (process_time() - began) / times.steps
    finally:
        composition.close()


def environment_step_s(env: gymnasium.Env[np.ndarray, np.ndarray], seed: int) -> float:
    """Return the time of a step of an environment; `reset` is not counted [s]."""
    observation, _ = env.reset(seed=seed)
    steps, ended, began = 0, False, process_time()
    while not ended:
        action = np.array([towards(float(observation[0]))], np.float32)
        observation, _, terminated, truncated, _ = env.step(action)
        steps, ended = steps + 1, terminated or truncated
    return (process_time() - began) / steps


def resident_kib() -> float:
    """Return the memory that this process holds [KiB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1024.0


def leak_kib(count: int = 50, first: int = 10) -> float:
    """Return the growth of memory per environment that is made, stepped and closed [KiB]."""
    before = 0.0
    for number in range(first + count):
        if number == first:
            gc.collect()
            before = resident_kib()
        env = gymnasium.make("cosim/midblock_zebra-v0", time_limit_s=5.0, warmup_s=2.0)
        env.reset(seed=number)
        for _ in range(5):
            env.step(np.zeros(1, np.float32))
        env.close()
    gc.collect()
    return (resident_kib() - before) / count


def main() -> int:
    """Measure, print, and return the exit code."""
    env = gymnasium.make("cosim/midblock_zebra-v0", time_limit_s=TIME_LIMIT_S, **SETTINGS)
    plain_step_s(1, observing=True)
    bare, plain, wrapped = [], [], []
    for seed in range(1, ROUNDS + 1):
        bare.append(plain_step_s(seed, observing=False))
        plain.append(plain_step_s(seed, observing=True))
        wrapped.append(environment_step_s(env, seed))
        env.unwrapped.close()
    env.close()
    share = median(wrapped) / median(plain) - 1.0
    bare_ms, loop_ms, wrapped_ms = (1e3 * median(times) for times in (bare, plain, wrapped))
    print(f"a step of the loop with the same policy and observation {loop_ms:.2f} ms, of the environment")
    print(f"{wrapped_ms:.2f} ms: overhead {share:+.1%}; bar {OVERHEAD_BAR:.0%}")
    print(f"a step of the loop without an observation {bare_ms:.2f} ms: {wrapped_ms / bare_ms - 1.0:+.1%}")
    leaked = leak_kib()
    print(f"50 environments: {leaked:+.0f} KiB each; bar {LEAK_BAR_KIB:.0f} KiB")
    return int(share > OVERHEAD_BAR or leaked > LEAK_BAR_KIB)


if __name__ == "__main__":
    print(f"Gymnasium {gymnasium.__version__}, {len(cosim.gym.NAMES)} environments registered")
    sys.exit(main())
