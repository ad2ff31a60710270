"""The request of a run, made from an environment's arguments."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from os import PathLike

from cosim.errors import InputError
from cosim.gym.episode import SLACK_S
from cosim.running.inventory import as_text, scenario_settings
from cosim.running.request import RunRequest

WARMUP_S = 30.0
"""Longest default warm-up of an episode, shorter than in some scenarios so that episodes begin sooner [s]."""


def request_of(
    scenario: str | PathLike[str],
    action: str,
    time_limit_s: float,
    sensing: str | None,
    ego_route: str,
    ego_vehicle: str | None,
    parameters: Mapping[str, object],
    egos: int,
) -> Callable[[int], RunRequest]:
    """Return a function that makes the request of an episode from its seed.

    Raises
    ------
    InputError
        If the scenario does not exist, or the time limit or the warm-up is not a valid number.
    """
    if not 0.0 < time_limit_s < float("inf"):
        raise InputError(f"time_limit_s: expected a number of seconds above 0, got {time_limit_s:g}")
    own = ego_route or ego_vehicle is not None
    there = scenario_settings(str(scenario))
    settings = {key: as_text(value) for key, value in parameters.items()}
    if float(there.get("warmup_s", 0.0)) > WARMUP_S:
        settings.setdefault("warmup_s", repr(WARMUP_S))
    warmup_s = _seconds("warmup_s", settings.get("warmup_s", there.get("warmup_s", 0.0)))
    if "ego_count" in there and not own:
        settings.setdefault("ego_count", str(egos))
    if not str(scenario).startswith("suite:"):
        first, headway = (
            _seconds(name, settings.get(name, there.get(name) or 0.0))
            for name in ("ego_first_depart_s", "ego_headway_s")
        )
        needed = warmup_s + first + headway * (egos - 1) + time_limit_s + SLACK_S
        settings.setdefault("duration_s", repr(needed))

    def made(seed: int) -> RunRequest:
        return RunRequest(
            scenario=str(scenario),
            controller="vo_mpc" if action == "decision" else "sumo",
            seed=seed,
            settings={**settings, "lane_changes": "false"} if action == "decision" else settings,
            sensing=sensing,
            ego_route=tuple(ego_route.split()),
            ego_vehicle=ego_vehicle,
        )

    return made


def _seconds(name: str, value: str | float) -> float:
    try:
        return float(value)
    except ValueError:
        raise InputError(f"{name}: expected a number of seconds, got {value!r}") from None
