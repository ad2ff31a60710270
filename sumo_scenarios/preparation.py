"""Prepares a scenario for SUMO: its command line, and the hashes of all inputs."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from string import Template

from sumo_scenarios.demand import fill, placeholders
from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.file_names import plain_name
from sumo_scenarios.model import NEVER, Scenario
from sumo_scenarios.network_cache import build_network, source_files
from sumo_scenarios.outputs import NOWHERE, SilentCopies, included_files
from sumo_scenarios.pedestrian_tables import TrajectoryTable
from sumo_scenarios.private_copy import private_configuration
from sumo_scenarios.recorded_vehicles import read_recorded_vehicles, vehicles_file
from sumo_scenarios.replaced_types import types_file, with_types
from sumo_scenarios.schema import LONGEST_STEP_S, SHORTEST_STEP_S
from sumo_scenarios.sumocfg import read_sumocfg
from sumo_scenarios.xml_files import sha256

SOONEST_TELEPORT_S = 300.0
"""Shortest time before a teleport; SUMO drives a standing ego earlier (`cosim.sumo.stranded`) [s]."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """A scenario that SUMO can start."""

    options: tuple[str, ...]
    """SUMO's command line without the program."""
    net_file: Path
    begin_s: float
    """Simulated time of the first step [s]."""
    inputs: dict[str, str]
    """SHA-256 of every input file, by a name that is the same on every machine."""
    left_out: tuple[str, ...] = ()
    """SUMO outputs that the inputs name but that are not written."""
    demand: tuple[Path, ...] = ()
    """The files from which SUMO reads vehicles, with those that they include."""


def prepare(scenario: Scenario, seed: int, work_dir: Path) -> Prepared:
    """Build or find the network, write the filled-in demand to ``work_dir``, and return what SUMO needs.

    Raises
    ------
    ScenarioError
        If an input file is missing or broken.
    """
    if scenario.sumocfg is not None:
        return _prepare_configuration(scenario, seed, scenario.sumocfg, work_dir)
    table = scenario.table
    if table is None or table.network is None or table.demand is None or scenario.folder is None:
        raise ScenarioError(f"{scenario.name}: has neither a network nor a SUMO configuration")
    net_file = build_network(scenario.folder, table.network)
    values = placeholders(scenario, table)
    filled: dict[str, list[Path]] = {"routes": [], "additional": []}
    for kind, names in (("routes", table.demand.routes), ("additional", table.demand.additional)):
        for name in (Template(name).safe_substitute(values) for name in names):
            target = work_dir / Path(name).name
            if target in filled["routes"] or target in filled["additional"]:
                raise ScenarioError(f"{scenario.name}: two demand files are called {target.name}")
            fill(scenario.folder / name, values, target)
            filled[kind].append(target)
    included = [file for path in (*filled["routes"], *filled["additional"]) for file in included_files(path)]
    copies = SilentCopies(work_dir)
    silent = {kind: ",".join(str(copies.of(path)) for path in paths) for kind, paths in filled.items()}
    options = ["--net-file", plain_name(net_file, work_dir), "--route-files", silent["routes"]]
    if silent["additional"]:
        options += ["--additional-files", silent["additional"]]
    sources = [path for paths in source_files(scenario.folder, table.network).values() for path in paths]
    inputs = _hashes(scenario.folder, sources)
    inputs["network"] = sha256(net_file)
    inputs |= _hashes(work_dir, [*filled["routes"], *filled["additional"], *included])
    inputs |= _pedestrians(scenario) | _recorded_vehicles(scenario)
    left_out = tuple(dict.fromkeys(copies.left_out))
    demand = (*filled["routes"], *filled["additional"], *included)
    options += _run_options(scenario, seed)
    return Prepared(tuple(options), net_file, scenario.begin_s, inputs, left_out, demand)


def _prepare_configuration(scenario: Scenario, seed: int, sumocfg: Path, work_dir: Path) -> Prepared:
    # Only the step of a configuration is not checked yet.
    if not SHORTEST_STEP_S <= scenario.step_s <= LONGEST_STEP_S:
        limits = f"{SHORTEST_STEP_S:g} to {LONGEST_STEP_S:g} s"
        raise ScenarioError(f"{sumocfg}: step-length is {scenario.step_s:g} s; expected {limits}")
    configuration, types = read_sumocfg(sumocfg), types_file(scenario)
    demand = (*configuration.route_files, *configuration.additional_files)
    included = [file for path in demand for file in included_files(path)]
    files = (sumocfg, configuration.net_file, *demand, *included)
    copies = SilentCopies(work_dir)
    if types is not None:
        configuration = with_types(configuration, types, work_dir)
    copy, left_out = private_configuration(configuration, work_dir, copies)
    options = ("--configuration-file", str(copy), *_run_options(scenario, seed))
    inputs = _hashes(sumocfg.parent, files) | _pedestrians(scenario)
    if types is not None:
        inputs["types"] = sha256(types)
    inputs |= _recorded_vehicles(scenario)
    left_out += dict.fromkeys(copies.left_out)
    demand = (*demand, *included)
    return Prepared(options, configuration.net_file, scenario.begin_s, inputs, tuple(left_out), demand)


def _hashes(folder: Path, files: Iterable[Path]) -> dict[str, str]:
    return {Path(os.path.relpath(file, folder)).as_posix(): sha256(file) for file in files}


def _pedestrians(scenario: Scenario) -> dict[str, str]:
    """Return the hash of the tables of scripted pedestrians, and of each file that they name."""
    hashes: dict[str, str] = {}
    said = []
    for table in scenario.pedestrians:
        if isinstance(table, TrajectoryTable):
            file = Path(table.file)
            hashes[f"{table.name}: {file.name}"] = sha256(file)
            table = table.model_copy(update={"file": file.name})  # paths of a machine are not part of a run
        said.append(repr(table))
    if said:
        hashes["pedestrians"] = hashlib.sha256("\n".join(said).encode()).hexdigest()
    return hashes


def _recorded_vehicles(scenario: Scenario) -> dict[str, str]:
    """Return the hash of the checked file of recorded vehicles; empty without one."""
    file = vehicles_file(scenario)
    if file is None:
        return {}
    read_recorded_vehicles(file)
    return {"recorded vehicles": sha256(file)}


def _teleport_after_s(scenario: Scenario) -> float:
    """Return how long SUMO lets a vehicle stand, long enough that no ego is teleported [s]."""
    wanted = scenario.teleport_after_s
    return max(wanted, SOONEST_TELEPORT_S) if wanted > 0.0 else NEVER


def _run_options(scenario: Scenario, seed: int) -> tuple[str, ...]:
    """Return the options that every run sets; they override a configuration's."""
    options = [
        *("--seed", str(seed)),
        *("--random", "false"),
        *("--begin", f"{scenario.begin_s:.3f}"),
        *("--step-length", f"{scenario.step_s:g}"),
        # With the ballistic method, the reported speeds of moved vehicles are wrong.
        *("--step-method.ballistic", "false"),
        # SUMO's defaults hide collisions: vehicles are teleported away and junctions are not checked.
        *("--collision.action", "warn"),
        *("--collision.check-junctions", "true"),
        *("--collision.mingap-factor", "0"),
        *("--intermodal-collision.action", "warn"),
        *("--time-to-teleport", f"{_teleport_after_s(scenario):g}"),
        *("--time-to-teleport.highways", "0"),
        *("--no-step-log", "true"),
        *("--no-warnings", "true"),
        *("--duration-log.disable", "true"),
        *("--xml-validation", "never"),
        # Without a name, SUMO writes a file per vehicle into the current folder.
        *("--device.ssm.file", NOWHERE),
    ]
    if scenario.lateral_resolution_m is not None:
        # SUMO accepts only one of the two lane-change models.
        options += [
            "--lateral-resolution",
            f"{scenario.lateral_resolution_m:g}",
            "--lanechange.duration",
            "0",
        ]
    return tuple(options)
