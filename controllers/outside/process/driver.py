"""A controller that lets a program make its decisions."""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable
from typing import Annotated, TypeVar

import numpy as np
from pydantic import Field, ValidationError

from controllers.driving import lane_keeping
from controllers.interface import Command, Controller, Decision, Manoeuvre, Perception, Plan
from controllers.outside.process.link import Late, Link, LinkError
from controllers.outside.process.messages import PROTOCOL, Hello
from controllers.outside.process.messages import Command as Answer
from controllers.outside.process.telling import decision_of, plan_of, told
from controllers.settings import ControllerSettings, NotNegative, Positive

Made = TypeVar("Made")
LATE = "fallback_late"
"""Status of a step in which the program has not answered in time."""


class Settings(ControllerSettings):
    """What can be set of a controller that is a program."""

    deadline_ms: Positive = 100.0
    """Wall-clock time for an answer; after that the fallback drives, and the late answer is thrown away."""
    fallback_braking_mps2: NotNegative = 3.0
    """Deceleration of the fallback, which keeps the lane."""
    patience_s: Positive = 5.0
    """A program that answers nothing for so long ends the run."""
    start_timeout_s: Annotated[float, Field(gt=0.0, le=600.0)] = 10.0
    """Wall-clock time for the program to start and to connect."""


class ProcessController:
    """Asks a program in every step; see ``docs/outside-controllers.md``.

    Parameters
    ----------
    command
        Program and arguments as a shell would take them.
    settings

    Raises
    ------
    LinkError
        If the program does not start, or speaks another version of the protocol.
    """

    def __init__(self, command: str, settings: Settings) -> None:
        self._settings = settings
        words = shlex.split(command)
        if not words:
            raise LinkError("process: expected a program, for instance process:./my_controller")
        self._program = words[0]
        self._link = Link(words, settings.start_timeout_s)
        try:
            self._greet()
        except BaseException:
            self._link.close()
            raise
        self._step = 0
        self._silent_s = 0.0
        self._answer: Answer | None = None

    def decide(self, perception: Perception) -> Decision:
        """Ask the program; keep the lane if it does not answer in time."""
        self._step += 1
        self._link.send(told(perception, self._step))
        self._answer = self._received()
        if self._answer is None:
            return Decision(Manoeuvre.KEEP, perception.road.reference)
        return self._checked(lambda answer: decision_of(answer, perception))

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return the program's plan, or else the declared fallback: braking in the lane."""
        if self._answer is None:
            times = lane_keeping.instants(perception.ego)
            acceleration = np.full(len(times), -self._settings.fallback_braking_mps2)
            steering = lane_keeping.steering(perception, 0.0, acceleration)
            return Plan(Command(times, acceleration, steering), solved=False, status=LATE)
        return self._checked(lambda answer: plan_of(answer, perception, decision))

    def close(self) -> None:
        """End the program."""
        self._link.close()

    def _greet(self) -> None:
        message = self._link.hello(self._settings.start_timeout_s)
        try:
            hello = Hello.model_validate(message)
        except ValidationError as error:
            raise LinkError(f"{self._program} sent a wrong first message: {_told(error)}") from error
        if hello.protocol != PROTOCOL:
            raise LinkError(
                f"{self._program} speaks version {hello.protocol} of the step protocol; expected {PROTOCOL}"
            )
        self._link.send({"type": "start", "protocol": PROTOCOL, "seed": self._settings.seed})

    def _received(self) -> Answer | None:
        """Return the answer to this step, skipping answers to earlier ones; ``None`` if it is late."""
        deadline_s = 1e-3 * self._settings.deadline_ms
        until = time.monotonic() + deadline_s
        while True:
            try:
                message = self._link.receive(max(until - time.monotonic(), 0.0))
            except Late:
                self._silent_s += deadline_s
                if self._silent_s >= self._settings.patience_s:
                    raise LinkError(f"{self._program} has not answered for {self._silent_s:g} s") from None
                return None
            try:
                answer = Answer.model_validate(message)
            except ValidationError as error:
                raise LinkError(f"{self._program} sent a wrong command: {_told(error)}") from error
            self._silent_s = 0.0
            if answer.step == self._step:
                return answer
            if answer.step > self._step:
                raise LinkError(f"{self._program} answered step {answer.step}; this is step {self._step}")

    def _checked(self, made: Callable[[Answer], Made]) -> Made:
        assert self._answer is not None
        try:
            return made(self._answer)
        except ValueError as error:
            raise LinkError(f"{self._program} sent a wrong command: {error}") from error


def _told(error: ValidationError) -> str:
    first = error.errors(include_url=False)[0]
    place = ".".join(str(part) for part in first["loc"])
    return f"{place}: {first['msg'][:1].lower()}{first['msg'][1:]}, got {str(first['input'])[:60]!r}"


def builder(command: str) -> Callable[..., Controller]:
    """Return the ``build`` of a controller that is a program."""

    def build(settings: Settings) -> Controller:
        try:
            return ProcessController(command, settings)
        except LinkError as error:
            raise ValueError(str(error)) from error  # shown as one line before the run begins

    return build
