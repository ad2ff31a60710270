"""The environment of :func:`cosim.gym.several.parallel_env`."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any, ClassVar

import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from pettingzoo import ParallelEnv

from controllers.outside.view import Observation, View
from cosim.errors import InputError
from cosim.gym.actions import actions
from cosim.gym.environment import LARGEST_SEED
from cosim.gym.episode import Episode, Outcome
from cosim.gym.making import request_of
from cosim.gym.rewards import weights as weights_of


class ParallelCrossingEnv(ParallelEnv[str, Observation, Any]):  # type: ignore[misc]  # it has no types
    """Environment of several egos with one agent each; see :func:`cosim.gym.several.parallel_env`."""

    metadata: ClassVar[dict[str, Any]] = {"name": "cosim_crossings_v0", "render_modes": []}

    def __init__(
        self,
        scenario: str | PathLike[str],
        agents: int,
        action: str,
        weights: Mapping[str, float] | None,
        time_limit_s: float,
        pedestrians: int,
        sensing: str | None,
        parameters: Mapping[str, object],
    ) -> None:
        if agents < 1:
            raise InputError(f"agents: expected at least 1, got {agents}")
        self.render_mode = None
        self.view = View(pedestrians)
        self._actions = actions(action)
        self._weights = weights_of(weights)
        self._time_limit_s = time_limit_s
        self._request = request_of(scenario, action, time_limit_s, sensing, "", None, parameters, egos=agents)
        self.possible_agents = [f"ego_{number}" for number in range(1, agents + 1)]
        self.agents: list[str] = []
        self.observation_spaces = {
            name: spaces.Box(self.view.low, self.view.high, dtype=np.float32) for name in self.possible_agents
        }
        self.action_spaces = dict.fromkeys(self.possible_agents, self._actions.space)
        self._episode: Episode | None = None
        self._egos: dict[str, str] = {}
        """SUMO's name of each agent's ego."""
        self._random, _ = seeding.np_random()

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of an agent's observations."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of an agent's actions."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Begin a new simulation; agents whose egos are already present take part from the start."""
        if seed is not None:
            self._random, _ = seeding.np_random(seed)
        self.close()
        self._egos = {}
        drawn = int(self._random.integers(LARGEST_SEED))
        most = len(self.possible_agents)
        self._episode = Episode(
            self._request(drawn), self.view, self._actions, self._weights, self._time_limit_s, most
        )
        self.agents = self._names()
        return {name: self._observation(name) for name in self.agents}, {name: {} for name in self.agents}

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Drive on until the next plans are due; if no agent is left, until the next ego appears.

        Raises
        ------
        InputError
            If no agent is left, an agent has no action, or an action is not in the space.
        """
        if self._episode is None or not self.agents:
            raise InputError("no agent is left: call reset() before the next step()")
        missing = [name for name in self.agents if name not in actions]
        if missing:
            raise InputError(f"no action for {missing[0]}; expected one for each of {', '.join(self.agents)}")
        self._episode.command({self._egos[name]: actions[name] for name in self.agents})
        outcomes = self._episode.go_on()
        self._episode.await_agent()
        found: dict[str, Outcome] = {name: outcomes[self._egos[name]] for name in self.agents}
        observations = {name: one.observation for name, one in found.items()}
        self.agents = self._names()
        new = [name for name in self.agents if name not in found]
        observations |= {name: self._observation(name) for name in new}
        return (
            observations,
            {**{name: one.reward for name, one in found.items()}, **dict.fromkeys(new, 0.0)},
            {**{name: one.terminated for name, one in found.items()}, **dict.fromkeys(new, False)},
            {**{name: one.truncated for name, one in found.items()}, **dict.fromkeys(new, False)},
            {**{name: one.info for name, one in found.items()}, **{name: {} for name in new}},
        )

    def close(self) -> None:
        """End the simulation; a second call does nothing."""
        if self._episode is not None:
            self._episode.close()
            self._episode = None

    def _names(self) -> list[str]:
        """Return the agents that take part now; a new ego gets the next agent's name."""
        assert self._episode is not None
        for ego in self._episode.agents:
            if ego not in self._egos.values():
                self._egos[self.possible_agents[len(self._egos)]] = ego
        return [name for name, ego in self._egos.items() if ego in self._episode.agents]

    def _observation(self, name: str) -> Observation:
        assert self._episode is not None
        return self._episode.agents[self._egos[name]].observation
