"""Functions as controllers: a function answers a perception with an acceleration, a command or a plan."""

from __future__ import annotations

import numbers
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from controllers.driving import lane_keeping
from controllers.interface import (
    Command,
    Decision,
    Manoeuvre,
    Perception,
    Plan,
    constant_command,
)


@dataclass(slots=True)
class FromFunction:
    """Asks a function what to do; it keeps the lane unless the function steers."""

    function: Callable[[Perception], object]

    def decide(self, perception: Perception) -> Decision:
        """Keep the lane: what the function wants shows in its command."""
        return Decision(Manoeuvre.KEEP, perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return the function's answer as a plan."""
        return plan_of(self.function(perception), perception)


def plan_of(answer: object, perception: Perception) -> Plan:
    """Return a function's or program's answer as a plan.

    Parameters
    ----------
    answer
        A plan, a command, an acceleration [m/s^2], or an acceleration and a front-wheel angle [rad];
        without an angle the ego keeps its lane.
    perception
        The perception that was answered.

    Raises
    ------
    TypeError
        If the answer is anything else.
    """
    if isinstance(answer, Plan):
        return answer
    if isinstance(answer, Command):
        return Plan(answer)
    values = np.ravel(np.asarray(answer)) if _is_numeric(answer) else np.zeros(0)
    if len(values) not in (1, 2):
        raise TypeError(
            "expected a Plan, a Command, an acceleration, or an acceleration and a steering angle; "
            f"got {type(answer).__name__}"
        )
    if not np.isfinite(values).all():
        return Plan(constant_command(float(values[0]), float(values[-1])))  # refused by the check of commands
    times = lane_keeping.instants(perception.ego)
    acceleration = np.full(len(times), float(values[0]))
    if len(values) == 2:
        steering = np.full(len(times), float(values[1]))
    else:
        steering = lane_keeping.steering(perception, 0.0, acceleration)
    return Plan(Command(times, acceleration, steering))


def _is_numeric(answer: object) -> bool:
    if isinstance(answer, numbers.Real | np.ndarray):
        return not isinstance(answer, bool)
    return isinstance(answer, tuple | list) and all(isinstance(one, numbers.Real) for one in answer)
