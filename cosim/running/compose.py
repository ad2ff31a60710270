"""Builds all parts of a run; only this module names SUMO, concrete controllers and scenarios."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from analysis.errors import did_you_mean
from analysis.recording.extent import EVERYBODY
from controllers import catalog
from cosim.errors import InputError
from cosim.recording.provenance import Inputs
from cosim.running.rehearsal import rehearse
from cosim.running.request import RunRequest
from cosim.sensing import catalog as sensing_catalog
from cosim.sensing import chosen
from cosim.sensing.interface import Sensing
from cosim.step.drivers import Drivers, release
from cosim.step.loop import Record
from cosim.step.world import World
from cosim.sumo.world import SumoWorld
from sumo_scenarios import library
from sumo_scenarios.library import Scenario


@dataclass(frozen=True, slots=True)
class Composition:
    """A world at its first step, and the drivers of its egos."""

    world: World
    drivers: Drivers
    inputs: Inputs
    end_time: float
    """Simulated time at which the run is over [s]."""
    _work_dir: TemporaryDirectory[str]
    window: Record | None = None
    """Shows egos and plans in SUMO's window, if there is one."""
    outputs_left_out: tuple[str, ...] = ()
    """Outputs of SUMO that the input files name but that are not written."""

    def close(self) -> None:
        """End the simulation and remove the files from which it was started."""
        with ExitStack() as stack:
            stack.callback(self._work_dir.cleanup)
            stack.callback(self.drivers.close)
            self.world.close()


def compose(request: RunRequest) -> Composition:
    """Build the world, the drivers and the description of a run.

    Raises
    ------
    InputError
        If a scenario, controller or parameter is unknown, or SUMO refuses the input.
    """
    with _as_input_errors():
        tried = _tried(request)
        scenario = tried.scenario
        # If memory has run out, the files cannot be listed for removal; that must not hide how the run ended.
        work_dir = TemporaryDirectory(prefix="cosim-", ignore_cleanup_errors=True)
        try:
            prepared = library.prepare(scenario, request.seed, Path(work_dir.name))
            everybody = request.record == EVERYBODY
            world = SumoWorld(
                scenario, prepared, request.seed, gui=request.gui, sensing=tried.sensing, everybody=everybody
            )
        except BaseException:
            work_dir.cleanup()
            raise
    given = tried.controller
    drivers = Drivers(lambda seed: catalog.build(request.controller, seed=seed, **given), request.seed)
    inputs = _inputs(request, tried, prepared)
    end_time = prepared.begin_s + scenario.duration_s
    return Composition(world, drivers, inputs, end_time, work_dir, world.window(), prepared.left_out)


def inputs_of(request: RunRequest) -> Inputs:
    """Return the inputs that determine the numbers of a run, without starting SUMO.

    Raises
    ------
    InputError
        As for `compose`, except for errors that only SUMO finds.
    """
    with _as_input_errors(), TemporaryDirectory(prefix="cosim-") as work_dir:
        tried = _tried(request)
        return _inputs(request, tried, library.prepare(tried.scenario, request.seed, Path(work_dir)))


@dataclass(frozen=True, slots=True)
class _Tried:
    """The checked parts of a run."""

    scenario: Scenario
    controller: dict[str, object]
    """Parameters of the controller that the request gives."""
    sensing_name: str
    sensing: Sensing


def _tried(request: RunRequest) -> _Tried:
    """Return the scenario, the sensing and the given controller parameters; refuse impossible ones."""
    scenario = _with_egos(library.load(request.scenario), request)
    table = scenario.table.sensing if scenario.table is not None else {}
    model = request.sensing or chosen.name_in(table)
    known = (*library.parameter_names(scenario), *catalog.parameters(request.controller))
    sensing_texts, texts = chosen.split(request.settings, model, known)
    scenario, controller_texts = _with_parameters(scenario, request, texts)
    place = str((scenario.folder or Path()) / library.DEFINITION)
    sensing_name, sensing = chosen.choose(table, place, request.sensing, sensing_texts)
    has_egos = scenario.egos.routes or scenario.egos.vehicles or scenario.egos.share
    if not has_egos and request.record != EVERYBODY:
        raise InputError(
            f"{scenario.name} has no ego: choose one with --ego-route, --ego-vehicle or --ego-share"
        )
    given = _controller_parameters(request, scenario, sensing_name, controller_texts)
    # Build and try the controller once, so that parts that do not fit are refused before SUMO starts.
    trial = catalog.build(request.controller, seed=request.seed, **given)
    try:
        rehearse(str(request.controller), trial, given)
    finally:
        release(trial)
    return _Tried(scenario, given, sensing_name, sensing)


def _inputs(request: RunRequest, tried: _Tried, prepared: library.Prepared) -> Inputs:
    scenario = tried.scenario
    return Inputs(
        scenario=scenario.name,
        scenario_parameters=scenario_parameters(scenario),
        controller=str(request.controller),
        controller_parameters={**catalog.parameters(request.controller), **tried.controller},
        seed=request.seed,
        egos=asdict(scenario.egos),
        step_s=scenario.step_s,
        warmup_s=scenario.warmup_s,
        duration_s=scenario.duration_s,
        actuation=scenario.actuation,
        files=prepared.inputs,
        controller_files=catalog.files(request.controller),
        record=request.record,
        sensing=tried.sensing_name,
        sensing_parameters=sensing_catalog.values_of(tried.sensing),
    )


def scenario_parameters(scenario: Scenario) -> dict[str, Any]:
    """Return the values of a scenario's parameters, by the names that ``--set`` takes."""
    fixed = ("duration_s", "warmup_s", "step_s", "actuation", "lateral_resolution_m")
    demand = ("vehicles_per_hour", "pedestrians_per_hour")
    values = {key: getattr(scenario, key) for key in (*fixed, *demand)}
    return {key: value for key, value in values.items() if value is not None} | dict(scenario.parameters)


def _with_egos(scenario: Scenario, request: RunRequest) -> Scenario:
    """Return the scenario with the requested egos."""
    if request.ego_route:
        return library.with_egos(scenario, route=request.ego_route)
    if request.ego_vehicle is not None:
        return library.with_egos(scenario, vehicle=(request.ego_vehicle,))
    if request.ego_share is not None:
        return library.with_egos(scenario, share=request.ego_share)
    return scenario


def _with_parameters(
    scenario: Scenario, request: RunRequest, settings: Mapping[str, str]
) -> tuple[Scenario, Mapping[str, str]]:
    """Return the scenario as requested, and the settings that are not parameters of the scenario."""
    texts = dict(settings)
    if request.duration_s is not None:
        texts["duration_s"] = f"{_warmup(scenario, texts) + request.duration_s!r}"
    if request.step_s is not None:
        texts["step_s"] = f"{request.step_s!r}"
    if request.actuation is not None:
        texts["actuation"] = request.actuation
    return library.with_parameters(scenario, texts)


def _warmup(scenario: Scenario, texts: Mapping[str, str]) -> float:
    """Return the requested warm-up; 0 for a text that is no number, which is refused later [s]."""
    try:
        return float(texts.get("warmup_s", scenario.warmup_s))
    except ValueError:
        return 0.0


def _controller_parameters(
    request: RunRequest, scenario: Scenario, sensing: str, texts: Mapping[str, str]
) -> dict[str, object]:
    known, moved = catalog.parameters(request.controller), catalog.moved(request.controller)
    for key in texts:
        if key in moved:
            raise InputError(f"--set {key}: no such parameter any more: {moved[key]}")
        if key not in known:
            of_scenario = library.parameter_names(scenario)
            of_sensing = tuple(sensing_catalog.parameters(sensing))
            hint = did_you_mean(key, [*of_scenario, *known, *of_sensing])
            for flag, have in (("sensing", sensing_catalog.having(key)), ("controller", catalog.having(key))):
                hint = f"--{flag} {' or '.join(have)} has it; " if have else hint
            raise InputError(
                f"--set {key}: no such parameter; {hint}scenario {scenario.name!r} has "
                f"{', '.join(of_scenario)}; controller '{request.controller}' has "
                f"{', '.join(known) or 'none'}; sensing {sensing!r} has {', '.join(of_sensing) or 'none'}"
            )
    return catalog.parse(request.controller, texts)


@contextmanager
def _as_input_errors() -> Iterator[None]:
    try:
        yield
    except (library.ScenarioError, catalog.CatalogError) as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"the run's input cannot be prepared: {error}") from error
