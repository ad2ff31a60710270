"""Writes the scenario that simulates a recording: its network and signals, with the rebuilt demand."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pandas as pd

from analysis.files import write_text
from cosim.errors import InputError
from cosim.sumo.network import Network
from cosim.validation.demand import Rebuilt, Types, rebuild
from cosim.validation.types_file import types_of_classes
from sumo_scenarios import library
from sumo_scenarios.file_names import joined_names
from sumo_scenarios.replaced_types import types_file
from sumo_scenarios.sumocfg import read_sumocfg

CONFIGURATION = "rebuilt.sumocfg"
ROUTES = "rebuilt.rou.xml"
STEP_S = 0.1


@dataclass(frozen=True, slots=True)
class Site:
    """The parts of a scenario that are kept: everything but its demand."""

    name: str
    net_file: Path
    additional_files: tuple[Path, ...]
    begin_s: float
    options: dict[str, str]
    types: Types = field(default_factory=dict)
    """Types with which the scenario replaces those of its configuration, by class of road users."""


def read_site(name: str, work: Path) -> Site:
    """Return the network, signals, options and replaced types of a scenario.

    Parameters
    ----------
    name : name of a scenario, its folder, or a SUMO configuration
    work : folder for files that have to be built from plain sources

    Raises
    ------
    InputError
        If there is no such scenario, one of its files is missing, or it has several types of one class.
    """
    try:
        scenario = library.load(name)
        if scenario.sumocfg is not None:
            found = read_sumocfg(scenario.sumocfg)
            kept = {key: value for key, value in found.options.items() if key.startswith("pedestrian.")}
            types = types_of_classes(types_file(scenario))
            return Site(scenario.name, found.net_file, found.additional_files, found.begin_s, kept, types)
        work.mkdir(parents=True, exist_ok=True)
        prepared = library.prepare(scenario, 1, work)
    except (library.ScenarioError, OSError) as error:
        raise InputError(str(error)) from error
    options = dict(zip(prepared.options[::2], prepared.options[1::2], strict=False))
    added = tuple(Path(file) for file in options.get("--additional-files", "").split(",") if file)
    return Site(scenario.name, prepared.net_file, added, prepared.begin_s, {})


def write_site(
    folder: Path, site: Site, network: Network, frame: pd.DataFrame, types: Types, duration_s: float
) -> tuple[Path, Rebuilt]:
    """Write the configuration that simulates a recording, and return it with its demand.

    Parameters
    ----------
    folder : folder to write to
    site
    network : network of the site
    frame : placed samples from which the demand is rebuilt
    types : attributes of the types of road users
    duration_s : duration of the simulation [s]
    """
    folder.mkdir(parents=True, exist_ok=True)
    first = float(frame["time_s"].min())
    begin = site.begin_s - (first - first % 1.0)
    demand = rebuild(frame, network, folder / ROUTES, begin, types)
    path = write_configuration(folder / CONFIGURATION, site, ROUTES, duration_s)
    return path, demand


def write_configuration(path: Path, site: Site, routes: str, duration_s: float) -> Path:
    """Write a configuration of a site with other demand.

    Parameters
    ----------
    path : file to write to
    site
    routes : name of the route file beside it
    duration_s : duration of the simulation [s]
    """
    inputs = {
        "net-file": joined_names([str(site.net_file.resolve())]),
        "route-files": routes,
        "additional-files": joined_names(str(path.resolve()) for path in site.additional_files),
    }
    times = {
        "begin": f"{site.begin_s:g}",
        "end": f"{site.begin_s + duration_s:g}",
        "step-length": f"{STEP_S:g}",
    }
    options = {**{key: value for key, value in inputs.items() if value}, **times, **site.options}
    options["ignore-route-errors"] = "true"
    lines = [f"    <{key} value={quoteattr(value)}/>" for key, value in options.items()]
    return write_text(path, "\n".join(["<configuration>", *lines, "</configuration>", ""]))
