"""Turns trajectories and a network into the folder of a judged run, with the same files as a simulation."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from analysis.encounters.severity_scale import CONFLICTS
from analysis.errors import AnalysisError, StudyError
from analysis.files import read_csv, write_csv
from analysis.recording.extent import EVERYBODY
from analysis.results.analyse import analyse_run
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS
from analysis.screening.writing import write_ranking
from analysis.sealing import seal
from analysis.thresholds import Thresholds
from analysis.trajectories import dlr
from analysis.trajectories.reading import read_trajectories
from cosim.errors import InputError
from cosim.inspection.source import read_source
from cosim.recording import folders
from cosim.recording.provenance import Inputs
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from cosim.tracks.fit import ClassFit, Placed, as_rows, placed
from cosim.tracks.projection import Location, onto_network, read_location
from cosim.tracks.resampling import BODIES_FROM, clock_of, on_clock
from cosim.tracks.writing import DRIVER, write_recording
from sumo_scenarios.xml_files import sha256

FIT = "tracks_fit.csv"
LEAST_PEDESTRIANS = 30


@dataclass(frozen=True, slots=True)
class TracksRequest:
    """A user's request to judge trajectories."""

    tracks: str
    """File with trajectories, or ``tasi`` for the recording in that package."""
    network: Path
    """SUMO network, or a SUMO configuration that names one."""
    crs: str | None = None
    bodies: str | None = None
    """Sizes of bodies, ``assumed`` or ``recorded``; by default recorded if the layout has reliable ones."""
    out: Path | None = None

    def __post_init__(self) -> None:
        if self.bodies is not None and self.bodies not in BODIES_FROM:
            raise InputError(f"--bodies: expected {' or '.join(BODIES_FROM)}, got {self.bodies!r}")

    @property
    def file(self) -> Path:
        """File with the trajectories."""
        return dlr.packaged() if self.tracks == dlr.PACKAGED else Path(self.tracks)


@dataclass(frozen=True, slots=True)
class OnNetwork:
    """Trajectories on a network."""

    placed: Placed
    network: Network
    location: Location
    step_s: float
    assumed_bodies: bool
    """Whether lengths and widths are assumed."""


@dataclass(frozen=True, slots=True)
class Judged:
    """A judged recording of real traffic."""

    folder: Path
    fits: tuple[ClassFit, ...]
    assumed_bodies: bool
    encounters: int
    """Number of encounters of vehicles with pedestrians."""
    conflicts: int
    """Number of encounters whose severity is serious or worse."""


def read_on_network(request: TracksRequest) -> OnNetwork:
    """Read trajectories and put them onto the network.

    Raises
    ------
    InputError
        If the input is bad; the message is one line with the file, the row and what was expected.
    """
    net_file = read_source(request.network).net_file
    location = read_location(net_file)
    network = read_network(net_file)
    try:
        found = onto_network(read_trajectories(request.tracks, request.crs), location)
        clock = clock_of(found)
        frame = on_clock(found, clock, request.bodies)
        on_it = placed(frame, network, found.source)
    except AnalysisError as error:
        raise InputError(str(error)) from error
    assumed = not found.bodies_known if request.bodies is None else request.bodies == BODIES_FROM[0]
    return OnNetwork(on_it, network, location, clock.step_s, assumed)


def judge(request: TracksRequest, thresholds: Thresholds | None = None) -> Judged:
    """Put trajectories onto a network, write them as a recorded run, and judge it.

    Raises
    ------
    InputError
        As for `read_on_network`; no folder is left behind.
    """
    folders.check(request.out)
    found = read_on_network(request)
    existed = request.out is not None and request.out.is_dir()
    folder = folders.create_named(request.out, f"{_name(request)}-{DRIVER}")
    with folders.left_as_it_was(folder, existed):
        write_judged(folder, request, found, found.placed.frame, thresholds)
    rows = read_csv(folder / TRAFFIC_ENCOUNTERS.file)
    conflicts = sum(row["severity"] in CONFLICTS for row in rows)
    return Judged(folder, found.placed.fits, found.assumed_bodies, len(rows), conflicts)


def write_judged(
    folder: Path,
    request: TracksRequest,
    found: OnNetwork,
    frame: pd.DataFrame,
    thresholds: Thresholds | None = None,
    scenario: str | None = None,
) -> None:
    """Write samples as a recorded run into an empty folder, and judge it.

    Parameters
    ----------
    folder
    request, found
    frame : samples of ``found`` to write
    thresholds
    scenario : name of the run's scenario; by default that of the file
    """
    inputs = Inputs(
        scenario=scenario or _name(request),
        scenario_parameters={"crs": request.crs or "", "assumed_bodies": found.assumed_bodies},
        controller=DRIVER,
        controller_parameters={},
        seed=0,
        egos={},
        step_s=found.step_s,
        warmup_s=0.0,
        duration_s=None,
        actuation="none",
        files={"tracks": sha256(request.file), "network": sha256(found.location.path)},
        record=EVERYBODY,
    )
    write_recording(
        folder,
        frame,
        found.network,
        found.location,
        inputs,
        {"traffic_driver": DRIVER, "command": _again(request), "fit": as_rows(found.placed.fits)},
    )
    analyse_run(folder, thresholds)
    rows = as_rows(found.placed.fits)
    fit = write_csv(folder / FIT, list(rows[0]), [list(row.values()) for row in rows])
    seal(folder, [fit])
    if found.network.crossings:
        try:
            write_ranking(folder, LEAST_PEDESTRIANS)
        except StudyError as error:
            raise InputError(str(error)) from error


def _again(request: TracksRequest) -> str:
    """Return a command that repeats the judgement, without any path of this machine."""
    words = ["cosim", "analyse", request.file.name, "--network", request.network.name]
    for flag, value in (("--crs", request.crs), ("--bodies", request.bodies)):
        words += [] if value is None else [flag, value]
    return shlex.join(words)


def _name(request: TracksRequest) -> str:
    return request.file.name.split(".")[0] or DRIVER
