"""The environment of one ego: Gymnasium's own checks, episodes in SUMO, and every kind of wrong use."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import cosim.gym
from controllers.outside.view import View
from cosim.errors import InputError
from cosim.gym.environment import CrossingEnv
from cosim.gym.rewards import WEIGHTS

pytestmark = pytest.mark.sumo
NAME = "cosim/midblock_zebra-v0"
QUICK: dict[str, Any] = {"time_limit_s": 3.0, "warmup_s": 2.0}
STILL = np.zeros(1, np.float32)


@pytest.fixture
def env() -> Iterator[gymnasium.Env[Any, Any]]:
    made = gymnasium.make(NAME, **QUICK)
    yield made
    made.close()


@pytest.fixture
def crossing() -> Iterator[Callable[..., CrossingEnv]]:
    """Make environments, and close them however the test ends."""
    every: list[CrossingEnv] = []

    def make(scenario: str = "midblock_zebra", **arguments: Any) -> CrossingEnv:
        every.append(CrossingEnv(scenario, **arguments))
        return every[-1]

    yield make
    for env in every:
        env.close()


def observations(env: gymnasium.Env[Any, Any], seed: int | None) -> list[list[float]]:
    first, _ = env.reset(seed=seed)
    return [first.tolist(), *(env.step(np.array([1.0], np.float32))[0].tolist() for _ in range(20))]


def test_every_scenario_is_registered() -> None:
    assert set(cosim.gym.NAMES) <= set(gymnasium.registry)
    assert {NAME, "cosim/signalised_junction-v0", "cosim/scenario-v0"} <= set(cosim.gym.NAMES)


@pytest.mark.long
@pytest.mark.parametrize("action", ["acceleration", "acceleration_steering", "decision"])
def test_gymnasiums_checker_passes(action: str, crossing: Callable[..., CrossingEnv]) -> None:
    """Made directly, so that it tries no second environment beside the first one."""
    env = crossing(action=action, render_mode="rgb_array", **QUICK)
    with warnings.catch_warnings():
        # Actions are in units, and an environment without a registered name says so.
        warnings.filterwarnings("ignore", message=".*symmetric and normalized space")
        warnings.filterwarnings("ignore", message=".*not having a spec")
        check_env(env)


@pytest.mark.long
def test_the_registered_one_passes_without_the_second_window(env: gymnasium.Env[Any, Any]) -> None:
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*symmetric and normalized space")
        check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.long
def test_the_same_seed_gives_the_same_trajectory_and_another_one_another(
    crossing: Callable[..., CrossingEnv],
) -> None:
    env = crossing(warmup_s=20.0, time_limit_s=5.0)
    first, after = observations(env, 4), observations(env, None)
    assert observations(env, 4) == first
    assert observations(env, None) == after != first  # seeds are drawn, and drawn again
    assert observations(env, 5) != first


def test_an_episode_is_truncated_by_time_and_then_asks_for_a_reset(env: gymnasium.Env[Any, Any]) -> None:
    env.reset(seed=1)
    for _ in range(30):
        _, _, terminated, truncated, info = env.step(STILL)
    with pytest.raises(InputError, match=r"the episode has ended: call reset\(\)"):
        env.step(STILL)
    assert (terminated, truncated, info["ended"]) == (False, True, "time")
    assert info["time_s"] == pytest.approx(3.0)


def test_the_reward_is_the_weighted_sum_of_its_terms(crossing: Callable[..., CrossingEnv]) -> None:
    env = crossing(weights={"comfort": 3.0}, **QUICK)
    observation, _ = env.reset(seed=1)
    _, reward, _, _, info = env.step(np.array([2.0], np.float32))
    terms = info["reward_terms"]
    assert set(terms) == set(WEIGHTS)
    weights = {**WEIGHTS, "comfort": 3.0}
    assert reward == pytest.approx(sum(weights[name] * value for name, value in terms.items()))
    # 0.1 s at about the speed it had, over the limit.
    speed, limit = (float(observation[env.view.place(name)]) for name in ("speed_mps", "speed_limit_mps"))
    assert terms["progress"] == pytest.approx(0.1 * speed / limit, abs=0.003)


def test_a_contact_terminates(crossing: Callable[..., CrossingEnv]) -> None:
    """The pedestrian of the protocol's case crosses in front of a car that keeps its speed."""
    env = crossing("suite:fmvss127/crossing_right_25_30kmh", time_limit_s=60.0)
    env.reset(seed=1)
    terminated = truncated = False
    while not (terminated or truncated):
        observation, reward, terminated, truncated, info = env.step(STILL)
        assert env.observation_space.contains(observation)
    assert (terminated, info["ended"], info["clearance_m"]) == (True, "contact", 0.0)
    assert info["reward_terms"]["contact"] == -1.0
    assert reward < -90.0


def test_a_decision_changes_the_lane(crossing: Callable[..., CrossingEnv]) -> None:
    env = crossing(action="decision", time_limit_s=20.0, warmup_s=5.0)
    observation, _ = env.reset(seed=5)
    left = observation[env.view.place("lane_left")] == 1.0
    lanes = set()
    for _ in range(80):
        _, _, terminated, _, _ = env.step(1 if left else 2)
        if terminated:
            break
        lanes.add(env.perception.road.reference)
    assert (1 if left else -1) in lanes


def test_bounds_and_units_are_declared_and_the_picture_is_an_array(
    crossing: Callable[..., CrossingEnv],
) -> None:
    env = crossing(render_mode="rgb_array", pedestrians=2, **QUICK)
    units = ("_m", "_mps", "_mps2", "_rad", "_1pm")
    flags = [one.name for one in env.view.entries if not one.name.endswith(units)]
    assert {(one.low, one.high) for one in env.view.entries if one.name in flags} == {
        (0.0, 1.0),
        (0.0, 500.0),
    }
    assert len(env.view.entries) == env.observation_space.shape[0] == len(View(2))  # type: ignore[index]  # a box
    env.reset(seed=1)
    env.step(STILL)
    frame = env.render()
    assert frame is not None
    assert frame.shape == (320, 640, 3)
    assert frame.dtype == np.uint8
    assert len(np.unique(frame.reshape(-1, 3), axis=0)) > 3  # road, ego and more


@pytest.mark.parametrize(
    "action",
    [np.array([9.0], np.float32), np.array([math.nan], np.float32), np.zeros(2, np.float32), "brake", None],
)
def test_an_action_outside_the_space_is_one_line(env: gymnasium.Env[Any, Any], action: Any) -> None:
    env.reset(seed=1)
    with pytest.raises(InputError, match=r"expected 1 numbers between \[-8") as caught:
        env.unwrapped.step(action)
    assert "\n" not in str(caught.value)
    env.unwrapped.step(STILL)  # it goes on


def test_a_decision_that_is_none_is_one_line(crossing: Callable[..., CrossingEnv]) -> None:
    env = crossing(action="decision", **QUICK)
    env.reset(seed=1)
    with pytest.raises(InputError, match=r"expected one of 0 \(straight\)"):
        env.step(3)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"action": "jump"}, "expected one of acceleration"),
        ({"weights": {"speed": 1.0}}, "no term 'speed'; there are progress"),
        ({"render_mode": "human"}, "render_mode: expected rgb_array"),
        ({"time_limit_s": 0.0}, "time_limit_s: expected"),
        ({"warmup_s": "abc"}, "warmup_s: expected a number of seconds, got 'abc'"),
        ({"scenario": "no_such"}, "no_such"),
    ],
)
def test_wrong_arguments_are_one_line_when_it_is_made(
    arguments: dict[str, Any], told: str, crossing: Callable[..., CrossingEnv]
) -> None:
    with pytest.raises(InputError, match=told):
        crossing(**{"scenario": "midblock_zebra", **arguments})


def test_an_unknown_parameter_is_told_at_the_first_reset(crossing: Callable[..., CrossingEnv]) -> None:
    env = crossing(pedestrians_per_day=3)
    with pytest.raises(InputError, match="no such parameter"):
        env.reset(seed=1)


def test_a_second_environment_of_the_process_is_refused(env: gymnasium.Env[Any, Any]) -> None:
    env.reset(seed=1)
    second = gymnasium.make(NAME, **QUICK)
    with pytest.raises(InputError, match="one a process: close the other environment") as caught:
        second.reset(seed=1)
    assert "\n" not in str(caught.value)
    env.close()
    second.reset(seed=1)
    second.close()


def test_a_step_before_the_first_reset_is_refused(crossing: Callable[..., CrossingEnv]) -> None:
    with pytest.raises(InputError, match=r"call reset\(\) first"):
        crossing().step(STILL)


def test_environments_run_at_the_same_time_in_processes_of_their_own() -> None:
    env = gymnasium.vector.AsyncVectorEnv([lambda: gymnasium.make(NAME, **QUICK)] * 2)
    first, _ = env.reset(seed=1)
    assert not np.array_equal(first[0], first[1])
    _, reward, _, _, info = env.step(np.zeros((2, 1), np.float32))
    assert reward.shape == (2,)
    assert (info["reward_terms"]["progress"] > 0.0).all()
    env.close()


def test_environments_that_are_closed_leave_no_file_and_no_folder_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def held() -> int:
        return len(os.listdir("/proc/self/fd"))

    before = 0
    for number in range(8):
        if number == 2:  # what is loaded once stays open
            before = held()
        env = gymnasium.make(NAME, **QUICK)
        env.reset(seed=number)
        env.step(STILL)
        env.close()
    assert held() == before
    assert os.listdir(tmp_path) == []


def test_without_gymnasium_the_command_is_told() -> None:
    code = (
        "import sys; sys.modules['gymnasium'] = None\n"
        "try:\n    import cosim.gym\nexcept Exception as error:\n    print(type(error).__name__, error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "InputError cosim.gym needs Gymnasium: pip install gymnasium\n"


def test_an_ego_that_is_given_up_ends_the_episode_at_once() -> None:
    """It has steered off the road; SUMO drives it from then on."""
    env = gymnasium.make(
        "cosim/midblock_zebra-v0",
        action="acceleration_steering",
        time_limit_s=60.0,
        warmup_s=1.0,
        pedestrians_per_hour=0,
        vehicles_per_hour=0,
    )
    env.reset(seed=1)
    terminated = truncated = False
    steps = 0
    while not (terminated or truncated):
        _, _, terminated, truncated, info = env.step(np.array([1.0, 0.05], np.float32))
        steps += 1
    env.close()
    assert (terminated, truncated, info["ended"]) == (False, True, "left_its_path")
    assert info["time_s"] == pytest.approx(0.1 * steps)
