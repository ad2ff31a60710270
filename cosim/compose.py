"""Builds what a run needs. The only place that names SUMO, concrete controllers and scenarios."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from controllers import catalog
from cosim.drivers import Drivers
from cosim.errors import InputError
from cosim.provenance import Inputs
from cosim.rehearsal import rehearse
from cosim.request import RunRequest
from cosim.sumo.world import SumoWorld
from cosim.world import World
from sumo_scenarios import library
from sumo_scenarios.library import Scenario


@dataclass(frozen=True, slots=True)
class Composition:
    """A world that stands at its first step, and who drives in it."""

    world: World
    drivers: Drivers
    inputs: Inputs
    end_time: float
    """Simulated time at which the run is over [s]."""
    _work_dir: TemporaryDirectory[str]

    def close(self) -> None:
        """End the simulation and remove the files it was started from."""
        try:
            self.world.close()
        finally:
            self._work_dir.cleanup()


def compose(request: RunRequest) -> Composition:
    """Build the world, the drivers and the description of a run.

    Raises
    ------
    InputError
        For an unknown scenario, controller or parameter, and for input that SUMO refuses.
    """
    with _as_input_errors():
        scenario, given = _tried(request)
        work_dir = TemporaryDirectory(prefix="cosim-")
        try:
            prepared = library.prepare(scenario, request.seed, Path(work_dir.name))
            world = SumoWorld(scenario, prepared, request.seed, gui=request.gui)
        except BaseException:
            work_dir.cleanup()
            raise
    drivers = Drivers(lambda seed: catalog.build(request.controller, seed=seed, **given), request.seed)
    inputs = _inputs(request, scenario, given, prepared)
    return Composition(world, drivers, inputs, prepared.begin_s + scenario.duration_s, work_dir)


def inputs_of(request: RunRequest) -> Inputs:
    """Return what decides the numbers of a run, without starting SUMO.

    Raises
    ------
    InputError
        As `compose`, but for what only SUMO finds.
    """
    with _as_input_errors(), TemporaryDirectory(prefix="cosim-") as work_dir:
        scenario, given = _tried(request)
        return _inputs(request, scenario, given, library.prepare(scenario, request.seed, Path(work_dir)))


def _tried(request: RunRequest) -> tuple[Scenario, dict[str, object]]:
    """Return the scenario and the controller's parameters that are given; what cannot be is refused."""
    scenario, controller_texts = _scenario(request)
    if not (scenario.egos.routes or scenario.egos.vehicles or scenario.egos.share):
        raise InputError(
            f"{scenario.name} has no ego: give --ego-route, --ego-vehicle or --ego-share to say which"
        )
    given = _controller_parameters(request, scenario, controller_texts)
    # Built and tried once for nothing: what does not fit together is refused before SUMO starts.
    rehearse(request.controller, catalog.build(request.controller, seed=request.seed, **given), given)
    return scenario, given


def _inputs(
    request: RunRequest, scenario: Scenario, given: Mapping[str, object], prepared: library.Prepared
) -> Inputs:
    return Inputs(
        scenario=scenario.name,
        scenario_parameters=scenario_parameters(scenario),
        controller=request.controller,
        controller_parameters={**catalog.parameters(request.controller), **given},
        seed=request.seed,
        egos=asdict(scenario.egos),
        step_s=scenario.step_s,
        warmup_s=scenario.warmup_s,
        duration_s=scenario.duration_s,
        actuation=scenario.actuation,
        files=prepared.inputs,
    )


def scenario_parameters(scenario: Scenario) -> dict[str, Any]:
    """Return the values of a scenario's parameters, by the names that ``--set`` takes."""
    fixed = ("duration_s", "warmup_s", "step_s", "actuation", "lateral_resolution_m")
    demand = ("vehicles_per_hour", "pedestrians_per_hour")
    values = {key: getattr(scenario, key) for key in (*fixed, *demand)}
    return {key: value for key, value in values.items() if value is not None} | dict(scenario.parameters)


def _scenario(request: RunRequest) -> tuple[Scenario, Mapping[str, str]]:
    """Return the scenario as asked for, and the settings that are none of its parameters."""
    texts = dict(request.settings)
    if request.duration_s is not None:
        texts["duration_s"] = f"{request.duration_s!r}"
    if request.actuation is not None:
        texts["actuation"] = request.actuation
    scenario = library.load(request.scenario)
    if request.ego_route:
        scenario = library.with_egos(scenario, route=request.ego_route)
    elif request.ego_vehicle is not None:
        scenario = library.with_egos(scenario, vehicle=(request.ego_vehicle,))
    elif request.ego_share is not None:
        scenario = library.with_egos(scenario, share=request.ego_share)
    return library.with_parameters(scenario, texts)


def _controller_parameters(
    request: RunRequest, scenario: Scenario, texts: Mapping[str, str]
) -> dict[str, object]:
    known = catalog.parameters(request.controller)
    for key in texts:
        if key not in known:
            of_scenario = library.parameter_names(scenario)
            near = difflib.get_close_matches(key, [*of_scenario, *known], n=1)
            hint = f"did you mean {near[0]!r}? " if near else ""
            raise InputError(
                f"--set {key}: no such parameter; {hint}scenario {scenario.name!r} has "
                f"{', '.join(of_scenario)}; controller {request.controller!r} has "
                f"{', '.join(known) or 'none'}"
            )
    return catalog.parse(request.controller, texts)


@contextmanager
def _as_input_errors() -> Iterator[None]:
    try:
        yield
    except (library.ScenarioError, catalog.CatalogError) as error:
        raise InputError(str(error)) from error
