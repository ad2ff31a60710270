"""From a scenario and tracks to the comparison of street and simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.errors import AnalysisError
from analysis.files import write_csv, write_json
from analysis.sealing import seal_tables
from analysis.tables.cells import cells
from analysis.tables.datapackage import describe
from analysis.validation.observed import observe
from analysis.validation.table import VALIDATION, Compared, compared, rows
from cosim.batches.batch import BatchRequest
from cosim.batches.study import check_seeds, study_of
from cosim.errors import InputError, SimulationError
from cosim.recording import folders
from cosim.recording.folders import DEFAULT_PARENT
from cosim.tracks.fit import as_rows
from cosim.tracks.judging import OnNetwork, TracksRequest, read_on_network, write_judged
from cosim.tracks.nearness import near_crossings
from cosim.validation.demand import Rebuilt
from cosim.validation.site import Site, read_site, write_site
from cosim.validation.span import spanned
from cosim.validation.types_file import read_types

REAL, SIMULATED, SCENARIO, WORK = "real", "simulated", "scenario", "network"
"""Folders of a validation."""
RECORD = "validation.json"


@dataclass(frozen=True, slots=True)
class ValidationRequest:
    """Request of a user for a validation."""

    scenario: str
    tracks: str
    seeds: str = "1-5"
    out: Path | None = None
    jobs: int | None = None
    crs: str | None = None
    bodies: str | None = None
    types: Path | None = None
    """Attributes of types, as a calibration writes them; other classes have the variant's, else SUMO's."""
    span_s: tuple[float, float] | None = None
    """Part of the recording that is simulated; ``None``: all of it."""
    again: str = ""

    @property
    def folder(self) -> Path:
        """Folder of the validation."""
        return DEFAULT_PARENT / f"validate-{Path(self.scenario).stem}" if self.out is None else self.out


@dataclass(frozen=True, slots=True)
class Plan:
    """A validation whose real side is judged and whose runs can begin."""

    request: ValidationRequest
    batch: BatchRequest
    found: OnNetwork
    demand: Rebuilt
    site: Site
    duration_s: float


@dataclass(frozen=True, slots=True)
class Validated:
    """Result of a validation."""

    folder: Path
    compared: Sequence[Compared]
    n_runs: int


def planned(request: ValidationRequest) -> Plan:
    """Judge the real side, rebuild its demand, and return the batch to be run.

    Raises
    ------
    InputError
        For a scenario, tracks or a file of types that cannot be; nothing is simulated then.
    """
    check_seeds(request.seeds, "cosim validate")
    folder = request.folder
    if not (folder / RECORD).is_file():
        folders.check(folder)
    with folders.left_as_it_was(folder, folder.is_dir()):
        return _planned(request)


def _planned(request: ValidationRequest) -> Plan:
    folder = request.folder
    given = read_types(request.types)
    site = read_site(request.scenario, folder / WORK)
    types = {**site.types, **given}
    tracks = TracksRequest(request.tracks, site.net_file, request.crs, request.bodies)
    found = read_on_network(tracks)
    if not found.network.crossings:
        raise InputError(
            f"{request.scenario}: the network has no crossings, near which everybody is recorded"
        )
    frame = spanned(found.placed.frame, request.span_s, found.step_s)
    if frame.empty:
        raise InputError(f"{request.tracks}: nobody appears in that part of the recording: {request.span_s}")
    duration = float(np.ceil(frame["time_s"].max()))
    folder.mkdir(parents=True, exist_ok=True)
    real = folder / REAL
    if real.is_dir():
        folders.discard(real)
    real.mkdir()
    write_judged(real, tracks, found, near_crossings(frame, found.network), scenario=site.name)
    path, demand = write_site(folder / SCENARIO, site, found.network, frame, types, duration)
    _write_record(folder, request, found, demand, duration, sorted({*site.types} - {*given}))
    content = {
        "scenarios": [str(path.resolve())],
        "controllers": ["sumo"],
        "seeds": request.seeds,
        "record": "everybody",
        "set": {"ego_share": 0.0, "duration_s": duration},
    }
    batch = BatchRequest(
        path,
        folder / SIMULATED,
        request.jobs,
        None,
        table=study_of(content, "cosim validate"),
        again=request.again,
    )
    return Plan(request, batch, found, demand, site, duration)


def _write_record(
    folder: Path,
    request: ValidationRequest,
    found: OnNetwork,
    demand: Rebuilt,
    duration_s: float,
    types_of_scenario: Sequence[str],
) -> None:
    write_json(
        folder / RECORD,
        {
            "scenario": request.scenario,
            "tracks": Path(request.tracks).name,
            "types": None if request.types is None else request.types.name,
            "types_of_scenario": list(types_of_scenario),
            "span_s": None
            if request.span_s is None
            else [request.span_s[0], min(request.span_s[1], request.span_s[0] + duration_s)],
            "duration_s": duration_s,
            "assumed_bodies": found.assumed_bodies,
            "inputs": ["departures", "places of departure", "destinations", "modes"],
            "departed": dict(sorted(demand.departed.items())),
            "left_out": dict(sorted(demand.left_out.items())),
            "fit": as_rows(found.placed.fits),
        },
    )


def finished(plan: Plan) -> Validated:
    """Compare the finished runs with the street, and write validation.csv.

    Raises
    ------
    SimulationError
        When no run can be compared.
    """
    folder = plan.request.folder
    runs = sorted(path.parent for path in (folder / SIMULATED).rglob("traffic.parquet"))
    try:
        real = observe(folder / REAL)
        simulated = [observe(run) for run in runs]
    except AnalysisError as error:
        raise SimulationError(str(error)) from error
    if not simulated:
        raise SimulationError(f"{folder / SIMULATED}: no run to compare")
    found = compared(real, simulated)
    write_comparison(folder, found)
    return Validated(folder, found, len(simulated))


def write_comparison(folder: Path, found: Sequence[Compared]) -> None:
    """Write validation.csv and its dictionary."""
    files = [
        write_csv(folder / VALIDATION.file, VALIDATION.names(), cells(VALIDATION, rows(found))),
        write_json(folder / "validation.datapackage.json", describe([VALIDATION], "real tracks beside runs")),
    ]
    seal_tables(folder, [*files, folder / RECORD])
