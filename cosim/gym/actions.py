"""Kinds of actions of an agent, and how an action becomes a command."""

from __future__ import annotations

from typing import Any, Protocol, cast

import numpy as np
from gymnasium import spaces

from controllers.interface import Command, Controller, Perception
from controllers.outside.functions import plan_of
from cosim.errors import InputError
from cosim.step.plant import CAR_DRIVE

DECISIONS = ("straight", "left", "right")
_ROUNDING = 1e-5
"""Tolerance by which a number of single precision may exceed its bound."""


class Actions(Protocol):
    """One kind of action."""

    space: spaces.Space[Any]

    def command(self, action: Any, perception: Perception, driver: Controller) -> Command:
        """Return the command for an action.

        Parameters
        ----------
        action
        perception
            What the agent was told.
        driver
            The run's controller for this ego, used by actions that leave the driving to it.

        Raises
        ------
        InputError
            If the action is not in the space.
        """
        ...


class Continuous:
    """Acceleration [m/s^2] and, unless the ego keeps its lane by itself, front-wheel angle [rad]."""

    def __init__(self, steered: bool) -> None:
        self._low = [-CAR_DRIVE.max_deceleration, *([-CAR_DRIVE.max_steering] if steered else [])]
        self._high = [CAR_DRIVE.max_acceleration, *([CAR_DRIVE.max_steering] if steered else [])]
        self.space: spaces.Space[Any] = spaces.Box(
            np.array(self._low, np.float32), np.array(self._high, np.float32), dtype=np.float32
        )

    def command(self, action: Any, perception: Perception, driver: Controller) -> Command:
        """Return a command that keeps the action constant."""
        try:
            values = [float(value) for value in action]
        except (TypeError, ValueError):
            values = []
        # NaN fails both comparisons, so it is refused.
        if len(values) != len(self._low) or not all(
            low - _ROUNDING <= value <= high + _ROUNDING
            for low, value, high in zip(self._low, values, self._high, strict=True)
        ):
            raise InputError(
                f"action {_shown(action)}: expected {len(self._low)} numbers between "
                f"{_shown(self._low)} and {_shown(self._high)}"
            )
        return plan_of(values, perception).command


class Decided:
    """Only the decision on the lane; the run's controller carries it out."""

    def __init__(self) -> None:
        self.space: spaces.Space[Any] = spaces.Discrete(len(DECISIONS))

    def command(self, action: Any, perception: Perception, driver: Controller) -> Command:
        """Begin a lane change if one is requested and possible, and let the controller drive."""
        if not self.space.contains(action):
            expected = ", ".join(f"{number} ({name})" for number, name in enumerate(DECISIONS))
            raise InputError(f"action {_shown(action)}: expected one of {expected}")
        side = {0: 0, 1: 1, 2: -1}[int(action)]
        if side:
            cast(Any, driver).begin_change(perception, side)
        return driver.plan(perception, driver.decide(perception)).command


KINDS = ("acceleration", "acceleration_steering", "decision")


def actions(kind: str) -> Actions:
    """Return the kind of action of this name.

    Raises
    ------
    InputError
        If no kind has this name.
    """
    if kind not in KINDS:
        raise InputError(f"action: expected one of {', '.join(KINDS)}, got {kind!r}")
    return Decided() if kind == "decision" else Continuous(steered=kind == "acceleration_steering")


def _shown(value: Any) -> str:
    return " ".join(np.array2string(np.asarray(value), precision=3, threshold=8).split())
