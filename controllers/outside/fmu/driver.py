"""A controller that lets a functional mock-up unit compute its acceleration and, optionally, its steering."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from controllers.interface import Controller, Decision, Manoeuvre, Perception, Plan
from controllers.outside.fmu.mapping import VIEW, Mapping, read_mapping
from controllers.outside.functions import plan_of
from controllers.outside.process.link import Late, Link, LinkError
from controllers.settings import ControllerSettings, Positive


class Settings(ControllerSettings):
    """What can be set of a controller that is a functional mock-up unit."""

    mapping: str = ""
    """File that says which variable is what; empty: that of the unit with the ending .toml."""
    patience_s: Positive = 10.0
    """A unit that does not end a step within this wall-clock time ends the run."""
    start_timeout_s: Annotated[float, Field(gt=0.0, le=600.0)] = 30.0
    """Wall-clock time for the unit to be loaded."""


class FmuController:
    """Steps a unit, which runs in a process of its own, once per plan interval.

    Parameters
    ----------
    path
        The ``.fmu`` file.
    settings

    Raises
    ------
    ValueError
        If the unit or its mapping cannot be used.
    """

    def __init__(self, path: Path, settings: Settings) -> None:
        self._path, self._patience_s = path, settings.patience_s
        command = [sys.executable, "-P", "-m", "controllers.outside.fmu.server", str(path)]
        places = os.pathsep.join(place or os.getcwd() for place in sys.path)
        self._link = Link(command, settings.start_timeout_s, PYTHONPATH=places)
        try:
            self._link.hello(settings.start_timeout_s)
            self._mapping = self._started(settings)
        except BaseException:
            self._link.close()
            raise
        self._sources = self._mapping.sources()
        outputs = self._mapping.outputs
        self._outputs = [one for one in (outputs.acceleration_mps2, outputs.steering_rad) if one is not None]

    def decide(self, perception: Perception) -> Decision:
        """Keep the lane."""
        return Decision(Manoeuvre.KEEP, perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Step the unit by one plan interval, and hold its outputs at the end of it."""
        seen = VIEW.observe(perception)
        inputs = {
            name: float(seen[VIEW.place(one.number)]) * one.scale for name, one in self._sources.items()
        }
        self._link.send(
            {
                "type": "step",
                "inputs": inputs,
                "outputs": self._outputs,
                "duration_s": perception.ego.plan_interval,
            }
        )
        return plan_of(self._answer(self._patience_s)["values"], perception)

    def close(self) -> None:
        """End the unit."""
        self._link.close()

    def _started(self, settings: Settings) -> Mapping:
        there = self._answer(settings.start_timeout_s)
        file = Path(settings.mapping) if settings.mapping else self._path.with_suffix(".toml")
        mapping = read_mapping(file, there["input"], there["output"], there["parameter"])
        self._link.send({"type": "start", "parameters": mapping.parameters})
        self._answer(settings.start_timeout_s)
        return mapping

    def _answer(self, within_s: float) -> dict[str, Any]:
        try:
            message = self._link.receive(within_s)
        except Late:
            raise LinkError(f"{self._path} has not answered within {within_s:g} s") from None
        if message["type"] == "error":
            raise LinkError(message["text"])
        return message


def builder(address: str) -> Callable[..., Controller]:
    """Return the ``build`` of a controller that is a unit."""

    def build(settings: Settings) -> Controller:
        try:
            return FmuController(Path(address), settings)
        except LinkError as error:
            raise ValueError(str(error)) from error  # shown as one line before the run begins

    return build
