"""Episodes of one or several agents in one simulation: which agents take part, and why an episode ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from controllers.interface import Perception
from controllers.outside.view import Observation, View
from cosim.errors import InputError
from cosim.gym.actions import Actions
from cosim.gym.contact import Nearness, nearness
from cosim.gym.rewards import terms
from cosim.gym.session import Session
from cosim.running.request import RunRequest
from cosim.step.world import EgoTruth, Snapshot

SLACK_S = 60.0
"""Simulated time added to an episode, so that egos find room to enter the road [s]."""


@dataclass(slots=True)
class Outcome:
    """The result of a plan interval for one agent."""

    observation: Observation
    reward: float
    terminated: bool
    truncated: bool
    info: dict[str, Any]


@dataclass(slots=True)
class Agent:
    """An ego that an agent drives."""

    name: str
    began_s: float
    perception: Perception
    observation: Observation
    truth: EgoTruth | None = None
    near: list[Nearness] = field(default_factory=list)


class Episode:
    """A simulation and the agents in it.

    Parameters
    ----------
    request
        The run to simulate.
    view, actions, weights
        What agents observe, how they act, and how the reward's terms are weighted.
    time_limit_s
        Simulated time after which an agent's episode is truncated [s].
    most
        Largest number of egos with an agent; egos get one in the order in which they appear.
    """

    def __init__(
        self,
        request: RunRequest,
        view: View,
        actions: Actions,
        weights: Mapping[str, float],
        time_limit_s: float,
        most: int = 1,
    ) -> None:
        self._session = Session(request)
        self._view, self._actions, self._weights = view, actions, weights
        self._time_limit_s, self._most = time_limit_s, most
        self._met: list[str] = []
        self._last: Snapshot | None = None
        self.agents: dict[str, Agent] = {}
        """Agents whose episode goes on, by the ego's name."""
        try:
            while not self._plan():
                self._advance()
        except BaseException:
            self.close()
            raise

    @property
    def session(self) -> Session:
        """The simulation."""
        return self._session

    def command(self, actions: Mapping[str, Any]) -> None:
        """Give the agents' egos their actions, by the ego's name.

        Raises
        ------
        InputError
            If an action is not in the space.
        """
        commands = {}
        for name, action in actions.items():
            perception = self.agents[name].perception
            commands[name] = self._actions.command(action, perception, self._session.driver(name))
        self._session.act(commands)

    def go_on(self) -> dict[str, Outcome]:
        """Drive until the next plans are due, and return the outcome for each agent."""
        before = {name: agent.truth for name, agent in self.agents.items()}
        began = self._last
        while True:
            self._advance()
            if self._plan() or self._session.over or not self._present() or self._given_up():
                break
        outcomes = {name: self._outcome(name, before[name], began) for name in before}
        for name, one in outcomes.items():
            if one.terminated or one.truncated:
                del self.agents[name]
        return outcomes

    def await_agent(self) -> None:
        """Without an agent, let SUMO drive on until the next ego gets one; there may be no further ego."""
        while not self.agents and len(self._met) < self._most and not self._session.over:
            self._session.act({})
            self._advance()
            self._plan()

    def close(self) -> None:
        """End the simulation."""
        self._session.close()

    def _present(self) -> bool:
        assert self._last is not None
        there = {ego.name for ego in self._last.egos}
        return any(name in there for name in self.agents) or not self.agents

    def _given_up(self) -> bool:
        """Return whether the ego of an agent was handed back to SUMO for good: its agent plans no more."""
        assert self._last is not None
        return any(name in self.agents for name in self._last.mishaps.given_up)

    def _plan(self) -> bool:
        """Sense, register new egos, and return whether an agent has to plan."""
        session = self._session
        if not session.sense() and not self._met:
            raise InputError("no ego appeared before the scenario ended")
        new = []
        for name, perception in session.perceptions.items():
            observation = self._view.observe(perception)
            if name in self.agents:
                self.agents[name].perception = perception
                self.agents[name].observation = observation
            elif name not in self._met and len(self._met) < self._most:
                self._met.append(name)
                self.agents[name] = Agent(name, perception.ego.time, perception, observation)
                new.append(name)
        if new:
            self._last = self._last or session.look()
            truths = {ego.name: ego for ego in self._last.egos}
            for name in new:
                self.agents[name].truth = truths[name]
        return any(name in self.agents for name in session.perceptions)

    def _advance(self) -> None:
        last, now = self._last, self._session.advance()
        if last is not None:
            earlier = {ego.name: ego for ego in last.egos}
            for ego in now.egos:
                if ego.name in self.agents and ego.name in earlier:
                    near = nearness(earlier[ego.name], ego, last, now)
                    self.agents[ego.name].near.append(near)
        for ego in now.egos:
            if ego.name in self.agents:
                self.agents[ego.name].truth = ego
        self._last = now

    def _outcome(self, name: str, before: EgoTruth | None, began: Snapshot | None) -> Outcome:
        agent, now = self.agents[name], self._last
        assert now is not None
        there = any(ego.name == name for ego in now.egos)
        nearest = min((one.pedestrian for one in agent.near), default=np.inf)
        near = Nearness(nearest, any(one.vehicle for one in agent.near))
        agent.near.clear()
        ended = self._ended(agent, there, near, now, began)
        truth = agent.truth
        assert before is not None
        assert truth is not None
        assert began is not None
        values = terms(before, truth, agent.perception.ego.across, near, now.time - began.time)
        reward = float(sum(self._weights[key] * value for key, value in values.items()))
        info = {
            "reward_terms": values,
            "time_s": now.time - agent.began_s,
            "clearance_m": min(near.pedestrian, 1000.0),
            "ended": ended,
        }
        terminated = ended in ("contact", "vehicle_contact", "arrived")
        return Outcome(agent.observation, reward, terminated, bool(ended) and not terminated, info)

    def _ended(self, agent: Agent, there: bool, near: Nearness, now: Snapshot, began: Snapshot | None) -> str:
        """Return why an agent's episode ended; empty if it goes on."""
        if near.touches_pedestrian:
            return "contact"
        if near.vehicle:
            return "vehicle_contact"
        if agent.name in now.mishaps.given_up:
            return "left_its_path"
        if not there:
            teleported = began is not None and now.teleports > began.teleports
            return "teleported" if teleported else "arrived"
        if self._session.over or now.time - agent.began_s >= self._time_limit_s - 1e-9:
            return "time"
        return ""
