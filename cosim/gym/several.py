"""Several egos in one simulation as a parallel environment of PettingZoo."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING

from cosim.errors import InputError

if TYPE_CHECKING:
    from cosim.gym.parallel import ParallelCrossingEnv


def parallel_env(
    scenario: str | PathLike[str],
    *,
    agents: int = 3,
    action: str = "acceleration",
    weights: Mapping[str, float] | None = None,
    time_limit_s: float = 60.0,
    pedestrians: int = 6,
    sensing: str | None = None,
    **parameters: object,
) -> ParallelCrossingEnv:
    """Return an environment with several agents, called ``ego_1``, ``ego_2``, … in order of appearance.

    The parameters are those of :class:`cosim.gym.environment.CrossingEnv`, and ``agents``: the number of egos
    that have an agent. SUMO drives the others. An agent appears with its ego and leaves when its episode
    ends.

    Raises
    ------
    InputError
        As for the environment of one ego, or if PettingZoo is missing.
    """
    try:
        from cosim.gym.parallel import ParallelCrossingEnv
    except ImportError as error:
        raise InputError("parallel_env needs PettingZoo: pip install pettingzoo") from error
    return ParallelCrossingEnv(
        scenario, agents, action, weights, time_limit_s, pedestrians, sensing, parameters
    )
