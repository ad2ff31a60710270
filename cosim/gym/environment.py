"""One ego as a Gymnasium environment."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from controllers.interface import Perception
from controllers.outside.view import Observation, View
from cosim.errors import InputError
from cosim.gym.actions import actions
from cosim.gym.episode import Episode
from cosim.gym.making import request_of
from cosim.gym.rewards import weights as weights_of

LARGEST_SEED = 2**31 - 1


class CrossingEnv(gymnasium.Env[Observation, Any]):
    """Environment in which an ego drives through a scenario; an episode is one simulation.

    Parameters
    ----------
    scenario
        Name, folder, ``suite:NAME/CASE`` or SUMO configuration. The agent drives the first ego; SUMO drives
        the others.
    action
        ``acceleration`` [m/s^2], where the ego keeps its lane itself; ``acceleration_steering`` [m/s^2, rad];
        or ``decision``: 0 straight, 1 left, 2 right, carried out by ``vo_mpc``.
    weights
        Weights of the reward's terms (:data:`cosim.gym.rewards.WEIGHTS`); terms not given keep their
        defaults.
    time_limit_s
        Simulated time after which an episode is truncated [s].
    pedestrians
        Number of pedestrians in an observation.
    render_mode
        ``rgb_array`` or none.
    sensing
        Sensing model with which the ego perceives pedestrians; by default that of the scenario.
    ego_route, ego_vehicle
        Route or vehicle of the ego, for scenarios that have none.
    **parameters
        Parameters of the scenario, by the names that ``--set`` takes.

    Attributes
    ----------
    view : View
        Name, bounds and meaning of every number of an observation (``view.entries``).

    Raises
    ------
    InputError
        For a scenario, parameter, weight or kind of action that does not exist.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012  Gymnasium declares it so

    def __init__(
        self,
        scenario: str | PathLike[str],
        *,
        action: str = "acceleration",
        weights: Mapping[str, float] | None = None,
        time_limit_s: float = 60.0,
        pedestrians: int = 6,
        render_mode: str | None = None,
        sensing: str | None = None,
        ego_route: str = "",
        ego_vehicle: str | None = None,
        **parameters: object,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise InputError(f"render_mode: expected rgb_array or none, got {render_mode!r}")
        self.render_mode = render_mode
        self.view = View(pedestrians)
        self._actions = actions(action)
        self._weights = weights_of(weights)
        self._time_limit_s = time_limit_s
        self._request = request_of(
            scenario, action, time_limit_s, sensing, ego_route, ego_vehicle, parameters, egos=1
        )
        self.observation_space = spaces.Box(self.view.low, self.view.high, dtype=np.float32)
        self.action_space = self._actions.space
        self._episode: Episode | None = None
        self._name = ""

    @property
    def perception(self) -> Perception:
        """Everything that the ego perceives now, as a controller would receive it."""
        return self._running().agents[self._name].perception

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin a new simulation; the seed determines all of it, including the demand.

        Raises
        ------
        InputError
            If the simulation cannot be set up, or another one runs in this process.
        """
        super().reset(seed=seed)
        self.close()
        drawn = int(self.np_random.integers(LARGEST_SEED))
        episode = Episode(self._request(drawn), self.view, self._actions, self._weights, self._time_limit_s)
        self._episode = episode
        (self._name,) = episode.agents
        return episode.agents[self._name].observation, {"sumo_seed": drawn}

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive on until the next plan is due.

        Raises
        ------
        InputError
            If the action is not in the space, or the episode has ended.
        """
        episode = self._running()
        episode.command({self._name: action})
        one = episode.go_on()[self._name]
        return one.observation, one.reward, one.terminated, one.truncated, one.info

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture of the ego's surroundings from above, shape (height, width, 3)."""
        if self.render_mode is None:
            return None
        from cosim.gym.picture import picture

        if self._episode is None:
            raise InputError("nothing to show before the first reset()")
        return picture(self._episode.session, self._name)

    def close(self) -> None:
        """End the simulation; a second call does nothing."""
        if self._episode is not None:
            self._episode.close()
            self._episode = None

    def _running(self) -> Episode:
        if self._episode is None:
            raise InputError("the environment has no episode: call reset() first")
        if self._name not in self._episode.agents:
            raise InputError("the episode has ended: call reset() before the next step()")
        return self._episode
