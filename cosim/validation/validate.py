"""Validates a scenario: simulates recorded demand, and compares the runs with the real tracks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from analysis.errors import AnalysisError
from analysis.files import read_json, write_csv, write_json
from analysis.recording.columns import TRAFFIC
from analysis.sealing import seal_tables
from analysis.tables.cells import cells
from analysis.tables.datapackage import describe
from analysis.validation.observed import observe
from analysis.validation.table import VALIDATION, Compared, compared, rows
from cosim.batches.batch import BatchRequest
from cosim.batches.ledger import RUNS
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
from sumo_scenarios.xml_files import sha256

REAL, SIMULATED, SCENARIO, WORK = "real", "simulated", "scenario", "network"
"""Folders of a validation."""
RECORD = "validation.json"
ASKED_FOR = "asked_for"
"""Key of the record for what has to be the same if a validation is resumed."""


@dataclass(frozen=True, slots=True)
class ValidationRequest:
    """A user's request for a validation."""

    scenario: str
    tracks: str
    seeds: str = "1-5"
    out: Path | None = None
    jobs: int | None = None
    crs: str | None = None
    bodies: str | None = None
    types: Path | None = None
    """File of types, as a calibration writes it; other classes use the scenario's types, or else SUMO's."""
    span_s: tuple[float, float] | None = None
    """Part of the recording to simulate; ``None`` for all of it [s]."""
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


@dataclass(frozen=True, slots=True)
class Validated:
    """Result of a validation."""

    folder: Path
    compared: Sequence[Compared]


def planned(request: ValidationRequest) -> Plan:
    """Judge the real side, rebuild its demand, and return the batch to be run.

    Raises
    ------
    InputError
        If the scenario, the tracks or the file of types are invalid, or the folder has another validation;
        nothing is simulated then.
    """
    check_seeds(request.seeds, "cosim validate")
    folder = request.folder
    if (folder / RECORD).is_file():
        _check_same(request)
    else:
        folders.check(folder)
    with folders.left_as_it_was(folder, folder.is_dir()):
        return _planned(request)


def _check_same(request: ValidationRequest) -> None:
    """Refuse the folder of another validation before anything in it is overwritten."""
    folder = request.folder
    try:
        before = read_json(folder / RECORD).get(ASKED_FOR)
        with TemporaryDirectory() as aside:
            now = _asked_for(request, read_site(request.scenario, Path(aside)))
    except AnalysisError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"{error.filename}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise InputError(
            f"--out {folder}: {RECORD} cannot be read ({error}); expected a new folder"
        ) from error
    if not isinstance(before, dict):
        raise InputError(
            f"--out {folder}: {RECORD} does not say what it was made from; expected a new folder"
        )
    if other := [key for key, value in now.items() if before.get(key) != value]:
        raise InputError(
            f"--out {folder}: the validation in it has another {' and '.join(other)}; "
            "expected the same, or a new folder"
        )


def _asked_for(request: ValidationRequest, site: Site) -> dict[str, Any]:
    """Return what determines the real side and the demand, with the SHA-256 of files."""
    tracks = TracksRequest(request.tracks, site.net_file, request.crs, request.bodies)
    span = request.span_s
    return {
        "scenario": site.name,
        "network": sha256(site.net_file),
        "tracks": sha256(tracks.file),
        "types": {**site.types, **read_types(request.types)},
        "span": None if span is None else [one if np.isfinite(one) else None for one in span],
        "crs": request.crs,
        "bodies": request.bodies,
    }


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
    _write_record(folder, request, site, found, demand, duration)
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
    return Plan(request, batch, found, demand)


def _write_record(
    folder: Path,
    request: ValidationRequest,
    site: Site,
    found: OnNetwork,
    demand: Rebuilt,
    duration_s: float,
) -> None:
    write_json(
        folder / RECORD,
        {
            "scenario": request.scenario,
            "tracks": Path(request.tracks).name,
            "types": None if request.types is None else request.types.name,
            "types_of_scenario": sorted({*site.types} - {*read_types(request.types)}),
            "span_s": None
            if request.span_s is None
            else [request.span_s[0], min(request.span_s[1], request.span_s[0] + duration_s)],
            "duration_s": duration_s,
            "assumed_bodies": found.assumed_bodies,
            "inputs": ["departures", "places of departure", "destinations", "modes"],
            "departed": dict(sorted(demand.departed.items())),
            "left_out": dict(sorted(demand.left_out.items())),
            "fit": as_rows(found.placed.fits),
            ASKED_FOR: _asked_for(request, site),
        },
    )


def finished(plan: Plan) -> Validated:
    """Compare the finished runs with the street, and write validation.csv.

    Raises
    ------
    SimulationError
        If no run can be compared.
    """
    folder = plan.request.folder
    runs = sorted(path.parent for path in (folder / SIMULATED / RUNS).glob(f"*/{TRAFFIC.file}"))
    try:
        real = observe(folder / REAL)
        simulated = [observe(run) for run in runs if read_json(run / "run.json").get("valid")]
    except AnalysisError as error:
        raise SimulationError(str(error)) from error
    if not simulated:
        raise SimulationError(f"{folder / SIMULATED}: no run to compare")
    found = compared(real, simulated)
    write_comparison(folder, found)
    return Validated(folder, found)


def write_comparison(folder: Path, found: Sequence[Compared]) -> None:
    """Write validation.csv and its dictionary."""
    files = [
        write_csv(folder / VALIDATION.file, VALIDATION.names(), cells(VALIDATION, rows(found))),
        write_json(folder / "validation.datapackage.json", describe([VALIDATION], "real tracks beside runs")),
    ]
    seal_tables(folder, [*files, folder / RECORD])
