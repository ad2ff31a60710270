"""The reward of a step: a sum of weighted terms, each with its own meaning."""

from __future__ import annotations

from collections.abc import Mapping

from cosim.errors import InputError
from cosim.gym.contact import Nearness
from cosim.step.world import EgoTruth

CLOSE = 1.5
"""Below this distance, passing a pedestrian has a cost [m]."""
HARD = 3.0
"""Acceleration at which the comfort term costs 1 per second [m/s^2]."""
LANE = 1.75
"""Lateral offset at which the lane term costs 1 per second [m]."""

WEIGHTS: Mapping[str, float] = {
    "progress": 1.0,
    "contact": 100.0,
    "vehicle_contact": 100.0,
    "closeness": 2.0,
    "comfort": 0.2,
    "lane": 0.2,
}
"""Default weights; every term but ``progress`` is a cost and never above 0."""


def weights(given: Mapping[str, float] | None) -> dict[str, float]:
    """Return the default weights, replaced by those that are given.

    Raises
    ------
    InputError
        If a term does not exist.
    """
    unknown = [name for name in given or {} if name not in WEIGHTS]
    if unknown:
        raise InputError(f"weights: no term {unknown[0]!r}; there are {', '.join(WEIGHTS)}")
    return {**WEIGHTS, **(given or {})}


def terms(
    before: EgoTruth, now: EgoTruth, across: float, near: Nearness, duration_s: float
) -> dict[str, float]:
    """Return the terms of one plan interval, without their weights.

    Parameters
    ----------
    before, now
        The ego at the beginning and end of the interval.
    across
        Offset from the middle of the lane [m].
    near
        How near the ego came to others.
    duration_s
        Length of the interval [s]; costs that accumulate over time are multiplied by it, so that they do not
        depend on the step length.

    Examples
    --------
    ``progress`` is 0.1 after 0.1 s at the speed limit; ``contact`` is −1 in the step of the contact.
    """
    travelled = now.route_position - before.route_position
    relative = min(now.speed / max(now.speed_limit, 0.1), 1.0)
    return {
        "progress": travelled / max(now.speed_limit, 0.1),
        "contact": -float(near.touches_pedestrian),
        "vehicle_contact": -float(near.vehicle),
        "closeness": -max(0.0, 1.0 - near.pedestrian / CLOSE) * relative * duration_s,
        "comfort": -((now.acceleration / HARD) ** 2) * duration_s,
        "lane": -((across / LANE) ** 2) * duration_s,
    }
