"""Several egos as agents: PettingZoo's own test, and who takes part when."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test

from cosim.errors import InputError
from cosim.gym import parallel_env

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


def test_every_agent_needs_an_action() -> None:
    env = parallel_env("midblock_zebra", agents=2, **QUICK)
    env.reset(seed=3)
    with pytest.raises(InputError, match="no action for ego_1"):
        env.step({})
    env.close()
    with pytest.raises(InputError, match="agents: expected at least 1"):
        parallel_env("midblock_zebra", agents=0)
