"""Several egos as agents: PettingZoo's own test, and who takes part when."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test

from cosim.errors import InputError
from cosim.gym import parallel_env
from cosim.gym.contact import nearness

pytestmark = pytest.mark.sumo
QUICK: dict[str, Any] = {"time_limit_s": 6.0, "warmup_s": 2.0, "ego_headway_s": 2.0}


@pytest.mark.long
def test_pettingzoos_own_test_passes() -> None:
    env = parallel_env("midblock_zebra", agents=3, **QUICK)
    parallel_api_test(env, num_cycles=120)
    env.close()


def test_agents_come_with_their_egos_and_go_after_their_time() -> None:
    env = parallel_env("midblock_zebra", agents=2, **QUICK)
    observations, _ = env.reset(seed=3)
    assert list(observations) == env.agents == ["ego_1"]
    seen: dict[str, int] = {}
    ended = {}
    while env.agents:
        actions = {name: np.zeros(1, np.float32) for name in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)
        assert set(observations) == set(rewards) == set(terminations) == set(truncations) == set(infos)
        for name in actions:
            seen[name] = seen.get(name, 0) + 1
            if truncations[name]:
                ended[name] = infos[name]["ended"]
    assert seen == {"ego_1": 60, "ego_2": 60}
    assert ended == {"ego_1": "time", "ego_2": "time"}
    with pytest.raises(InputError, match="no agent is left"):
        env.step({})
    env.close()


def test_the_next_ego_gets_its_agent_although_all_before_have_ended() -> None:
    """Meanwhile SUMO drives those that have ended; a headway beyond the slack makes the simulation longer."""
    env = parallel_env("midblock_zebra", agents=2, time_limit_s=2.0, warmup_s=2.0, ego_headway_s=70.0)
    env.reset(seed=3)
    steps: dict[str, int] = {}
    handed_back: dict[str, bool] = {}
    while env.agents:
        for name in env.agents:
            steps[name] = steps.get(name, 0) + 1
        env.step({name: np.zeros(1, np.float32) for name in env.agents})
        if env.agents:
            assert env._episode is not None
            assert env._episode._last is not None
            handed_back = {ego.name: ego.handed_back for ego in env._episode._last.egos}
    env.close()
    assert steps == {"ego_1": 20, "ego_2": 20}
    assert handed_back == {"ego_0": True, "ego_1": False}


@pytest.mark.parametrize(("behind_m", "overlaps"), [(3.0, True), (6.0, False)])
def test_one_ego_is_a_vehicle_to_the_other(behind_m: float, overlaps: bool) -> None:
    env = parallel_env("midblock_zebra", agents=2, **QUICK)
    env.reset(seed=3)
    while len(env.agents) < 2:
        env.step({name: np.zeros(1, np.float32) for name in env.agents})
    assert env._episode is not None
    seen = env._episode._last
    env.close()
    assert seen is not None
    one, other = seen.egos
    behind = replace(other, x=one.x - behind_m, y=one.y, heading=one.heading)
    together = replace(seen, egos=(one, behind))
    assert nearness(one, one, together, together).vehicle is overlaps


def test_every_agent_needs_an_action() -> None:
    env = parallel_env("midblock_zebra", agents=2, **QUICK)
    env.reset(seed=3)
    with pytest.raises(InputError, match="no action for ego_1"):
        env.step({})
    env.close()
    with pytest.raises(InputError, match="agents: expected at least 1"):
        parallel_env("midblock_zebra", agents=0)
