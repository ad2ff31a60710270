"""``cosim.run``: one scenario, one controller, one seed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import index
from os import PathLike
from pathlib import Path
from types import ModuleType
from typing import Any, TypeAlias

from analysis.recording.extent import EGOS
from controllers.interface import Controller, Perception
from controllers.outside.given import Given
from controllers.outside.handed_over import given
from cosim.api.recorded_run import Run
from cosim.errors import InputError
from cosim.running.execution import Outcome, execute
from cosim.running.inventory import as_text
from cosim.running.request import RunRequest

ControllerLike: TypeAlias = (
    str | Given | Controller | Callable[[Perception], Any] | Callable[..., Controller] | ModuleType
)
"""A name or an address; a function of a perception; a maker of controllers; an object; a module."""


def run(
    scenario: str | PathLike[str],
    *,
    controller: ControllerLike = "vo_mpc",
    seed: int = 1,
    out: str | PathLike[str] | None = None,
    duration_s: float | None = None,
    step_s: float | None = None,
    actuation: str | None = None,
    ego_route: str | Sequence[str] = (),
    ego_vehicle: str | None = None,
    ego_share: float | None = None,
    sensing: str | None = None,
    record: str = EGOS,
    progress: Callable[[float, float | None], None] = lambda time, end: None,
    **parameters: object,
) -> Run:
    """Drive egos through a scenario, analyse the recording, and return the run.

    The simulation runs in this process. A process can make any number of runs one after another, but only
    one at a time. The same arguments give the same files, byte for byte, apart from wall-clock times.

    Parameters
    ----------
    scenario
        Name of a scenario, its folder, ``suite:NAME/CASE``, or a SUMO configuration.
    controller
        A name (``cosim list controllers``) or an address (``./patient.py``); a function of a
        :class:`~controllers.interface.Perception` that returns an acceleration [m/s^2], a pair of
        acceleration and front-wheel angle [rad], a ``Command`` or a ``Plan``; a class or a function without
        required arguments that makes controllers; or an object with ``decide`` and ``plan``, of which
        every ego gets a copy.
    seed
        Seed of all random numbers, from 0 to 2^31 − 1.
    out
        New or empty folder; by default ``runs/<scenario>-<controller>-<seed>-<n>``.
    duration_s, step_s
        Time to record after the warm-up, and length of a step [s]; by default those of the scenario.
    actuation
        ``hybrid`` or ``move``; by default that of the scenario.
    ego_route, ego_vehicle, ego_share
        Edges of the route of an additional vehicle, which is the ego; id of a vehicle of the demand to take
        over as the ego; share of the passenger cars to take over as egos.
    sensing
        Name of a sensing model; by default that of the scenario.
    record
        ``egos`` or ``everybody``.
    progress
        Called after every step with the simulated time and the time of the end [s].
    **parameters
        Parameters of the scenario, the controller or the sensing model, by the names that ``--set`` takes.

    Returns
    -------
    Run
        The run, even if it failed after its first step; ``valid`` is then false.

    Raises
    ------
    InputError
        If anything is found wrong before the first step; the message is one line.
    SimulationError
        If this process is already running a simulation.
    """
    request = RunRequest(
        scenario=str(scenario),
        controller=_given(controller),
        seed=_seed(seed),
        settings={key: as_text(value) for key, value in parameters.items()},
        duration_s=_number("duration_s", duration_s),
        step_s=_number("step_s", step_s),
        actuation=actuation,
        ego_route=tuple(ego_route.split() if isinstance(ego_route, str) else ego_route),
        ego_vehicle=None if ego_vehicle is None else str(ego_vehicle),
        ego_share=_number("ego_share", ego_share),
        sensing=sensing,
        record=record,
        out=None if out is None else Path(out),
    )
    return _run_of(execute(request, progress))


def _run_of(outcome: Outcome) -> Run:
    if isinstance(outcome.error, KeyboardInterrupt):
        raise outcome.error  # what was recorded is kept; a loop over many runs ends here
    return Run(outcome.folder)


def _given(controller: ControllerLike) -> str | Given:
    try:
        return given(controller)
    except TypeError as error:
        raise InputError(str(error)) from error


def _seed(value: int) -> int:
    try:
        return index(value)
    except TypeError:
        raise InputError(f"seed: expected a whole number, got {value!r}") from None


def _number(name: str, value: float | None) -> float | None:
    try:
        return None if value is None else float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected a number, got {value!r}") from None
