"""Lets a controller take the place of one recorded vehicle; all other road users move as recorded."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from analysis.files import read_csv, write_csv, write_text
from analysis.tables.cells import cells, plain
from analysis.tables.column import Table, at_least_0, count, flag, row_of, text
from analysis.trajectories.table import PEDESTRIAN
from cosim.arrays import FloatArray
from cosim.batches.study import toml_value
from cosim.errors import InputError, SimulationError
from cosim.recording import folders
from cosim.running.execution import Outcome, execute
from cosim.running.request import RunRequest
from cosim.tracks.judging import OnNetwork, TracksRequest, read_on_network
from cosim.tracks.lanes import SUMO_CLASS
from cosim.validation.demand import allowed_name, rebuild
from cosim.validation.site import Site, read_site, write_configuration
from cosim.validation.span import spanned
from sumo_scenarios.recorded_vehicles import NUMBERS, TEXTS

BEFORE_S, AFTER_S = 5.0, 20.0
"""The scenario begins and ends this long before and after the recording of the vehicle [s]."""
STEP_S = 0.1
WORK = "network"
"""Folder of files built from the scenario's plain sources; the written scenario names files in it."""
VEHICLES, PEOPLE, OWN = "vehicles.csv", "people.csv", "recorded.csv"
OFF_M = 2.0
"""Beyond this distance from the recorded vehicle, the ego meets people in a different situation [m]."""


TABLE = Table(
    "stand_in",
    "One row for each encounter of the ego with a recorded pedestrian",
    (
        count("encounter_id", "number in encounters.csv", source="number", required=True),
        text("ped_id", "recorded pedestrian", source="pedestrian", required=True),
        at_least_0(
            "off_m", "m", "largest distance of the ego from the recorded vehicle so far", source="off_m"
        ),
        flag(
            "could_react",
            "they met the ego where and when they had met the recorded vehicle, within 2 m",
            source="could_react",
            required=True,
        ),
        at_least_0("min_dist_m", "m", "smallest distance, as in encounters.csv", source="distance"),
        text("severity", "as in encounters.csv", source="severity", required=True),
    ),
    ("encounter_id",),
)


@dataclass(frozen=True, slots=True)
class Met:
    """One encounter of the ego with a recorded pedestrian."""

    number: int
    pedestrian: str
    off_m: float
    """Largest distance of the ego from the recorded vehicle until the encounter was over [m]."""
    distance: float
    """Smallest distance between the two [m]."""
    severity: str

    @property
    def could_react(self) -> bool:
        """Whether the pedestrian met the ego where and when they met the recorded vehicle."""
        return self.off_m <= OFF_M


def write_stand_in(folder: Path, site: Site, found: OnNetwork, vehicle: str) -> Path:
    """Write the scenario in which an ego takes the place of a vehicle to a new folder.

    Raises
    ------
    InputError
        If there is no such vehicle, or it has no way through the network.
    """
    frame = found.placed.frame
    own = frame[frame["id"] == vehicle]
    if own.empty or str(own["kind"].iloc[0]) == PEDESTRIAN:
        raise InputError(f"{vehicle!r}: no such vehicle in the tracks")
    begin = max(0.0, np.floor(float(own["time_s"].min()) - BEFORE_S))
    end = float(own["time_s"].max()) + AFTER_S
    inside = frame[(frame["time_s"] >= begin) & (frame["time_s"] <= end)]
    part = spanned(inside, (begin, np.inf), found.step_s)
    folder.mkdir(parents=True)
    named: set[str] = set()
    ego = allowed_name(vehicle, named)
    demand = rebuild(
        part[part["id"] == vehicle], found.network, folder / "ego.rou.xml", site.begin_s, {}, True
    )
    if demand.left_out:
        raise InputError(f"{vehicle!r}: hardly moves, or has no way through the network")
    write_configuration(folder / "stand_in.sumocfg", site, "ego.rou.xml", end - begin)
    others = part[(part["id"] != vehicle) & (part["kind"] != PEDESTRIAN)]
    _write_vehicles(folder / VEHICLES, others, found, named)
    people = part[part["kind"] == PEDESTRIAN]
    columns = ("person", "time_s", "x_m", "y_m")
    _write(folder / PEOPLE, columns, _texts(people, ("id", "time_s", "x_m", "y_m")))
    _write(folder / OWN, columns[1:], _texts(part[part["id"] == vehicle], columns[1:]))
    walkers = (
        '\n[[pedestrians]]\nname = "real"\nkind = "trajectory"\nfile = "people.csv"\n' if len(people) else ""
    )
    write_text(
        folder / "scenario.toml",
        f"description = {toml_value(f'Recorded traffic around an ego in the place of {vehicle}')}\n"
        f'duration_s = {end - begin:.1f}\nstep_s = {STEP_S}\nsumocfg = "stand_in.sumocfg"\n'
        f'recorded_vehicles = "{VEHICLES}"\n\n[egos]\nvehicles = ["{ego}"]\n{walkers}',
    )
    return folder


def _texts(frame: pd.DataFrame, columns: tuple[str, ...]) -> list[list[str]]:
    kept = frame[(frame["step"] % 2 == 0) | ~frame["id"].duplicated()]
    return [
        [one if isinstance(one, str) else f"{one:.3f}" for one in row]
        for row in kept[list(columns)].to_numpy()
    ]


def _write(path: Path, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Write a table for a simulation; names stay as they are, even if a spreadsheet would misread them."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([heads, *rows])
    write_text(path, text.getvalue())


def _write_vehicles(path: Path, others: pd.DataFrame, found: OnNetwork, named: set[str]) -> None:
    half = 0.5 * others["length_m"].to_numpy()
    heading = others["heading_rad"].to_numpy()
    edges = {
        str(name): _edge(track["place"].to_list(), found) for name, track in others.groupby("id", sort=True)
    }
    table = others.assign(
        vehicle=others["id"].map({name: allowed_name(name, named) for name in edges}),
        edge=others["id"].map(edges),
        x_m=others["x_m"].to_numpy() + half * np.cos(heading),
        y_m=others["y_m"].to_numpy() + half * np.sin(heading),
    )
    table["class"] = others["kind"].map(SUMO_CLASS)
    table = table[table["edge"] != ""]
    _write(path, (*TEXTS, *NUMBERS), _texts(table, (*TEXTS, *NUMBERS)))


def _edge(places: list[str], found: OnNetwork) -> str:
    """Return the first edge outside junctions on which a vehicle was; empty if there is none."""
    lanes = found.network.lanes
    return next((lanes[one].edge for one in places if one in lanes and not lanes[one].internal), "")


def centres(egos: pd.DataFrame) -> FloatArray:
    """Return the centres of the bodies in rows of egos.parquet, shape (n, 2) [m]."""
    lever = 0.5 * egos["length_m"].to_numpy()
    heading = egos["heading_rad"].to_numpy()
    fronts = egos[["front_x_m", "front_y_m"]].to_numpy()
    return np.asarray(fronts - lever[:, None] * np.column_stack([np.cos(heading), np.sin(heading)]))


def off_recorded(scenario: Path, egos: pd.DataFrame) -> pd.Series:
    """Return how far the ego was from the recorded vehicle [m], by the scenario's time [s].

    Parameters
    ----------
    scenario : folder written by `write_stand_in`
    egos : egos.parquet of the run
    """
    with (scenario / OWN).open(encoding="utf-8", newline="") as file:
        rows = np.array([[float(one) for one in row] for row in list(csv.reader(file))[1:]])
    begin = float(egos["time_s"].iloc[0]) - rows[0, 0]
    time = egos["time_s"].to_numpy() - begin
    there = np.column_stack([np.interp(time, rows[:, 0], rows[:, column]) for column in (1, 2)])
    return pd.Series(np.hypot(*(centres(egos) - there).T), index=time)


def met_people(scenario: Path, egos: pd.DataFrame, encounters: Sequence[Mapping[str, str]]) -> list[Met]:
    """Return each encounter of a run, with the ego's distance from the recorded vehicle until its end.

    Parameters
    ----------
    scenario : folder written by `write_stand_in`
    egos, encounters : egos.parquet and the rows of encounters.csv of the run
    """
    off = off_recorded(scenario, egos).to_numpy()
    return [
        Met(
            int(one["encounter_id"]),
            one["ped_id"],
            float(off[egos["time_s"].to_numpy() <= float(one["t_end_s"]) + 1e-6].max()),
            float(one["min_dist_m"]),
            one["severity"],
        )
        for one in encounters
    ]


@dataclass(frozen=True, slots=True)
class StandInRequest:
    """A user's request for a drive in the place of a recorded vehicle."""

    scenario: str
    tracks: str
    vehicle: str
    controller: str = "vo_mpc"
    seed: int = 1
    settings: Mapping[str, str] = field(default_factory=dict)
    out: Path | None = None
    crs: str | None = None
    bodies: str | None = None


@dataclass(frozen=True, slots=True)
class Driven:
    """Result of a drive in the place of a recorded vehicle."""

    folder: Path
    outcome: Outcome
    met: Sequence[Met]
    has_signals: bool


def stand_in(request: StandInRequest) -> Driven:
    """Write the scenario, drive through it, and determine for each encounter whether the people could react.

    Raises
    ------
    InputError
        If the scenario, the tracks, the vehicle or the controller is invalid.
    SimulationError
        If the run ended before there was anything to analyse.
    """
    with _folder(request, Path(request.scenario).stem) as folder:
        site = read_site(request.scenario, folder / WORK)
        tracks = TracksRequest(request.tracks, site.net_file, request.crs, request.bodies)
        return _driven(folder, request, site, read_on_network(tracks))


def drive(request: StandInRequest, site: Site, found: OnNetwork) -> Driven:
    """Do the same as `stand_in` with a site and tracks already read, for several vehicles or other signals.

    Raises
    ------
    InputError
        If the vehicle or the controller is invalid.
    SimulationError
        If the run ended before there was anything to analyse.
    """
    with _folder(request, site.name) as folder:
        return _driven(folder, request, site, found)


@contextmanager
def _folder(request: StandInRequest, name: str) -> Iterator[Path]:
    existed = request.out is not None and request.out.is_dir()
    folder = folders.create_named(request.out, f"stand-in-{name}")
    with folders.left_as_it_was(folder, existed):
        yield folder


def _driven(folder: Path, request: StandInRequest, site: Site, found: OnNetwork) -> Driven:
    scenario = write_stand_in(folder / "scenario", site, found, request.vehicle)
    outcome = execute(
        RunRequest(str(scenario), request.controller, request.seed, request.settings, out=folder / "run")
    )
    if outcome.row is None:
        raise SimulationError(outcome.invalid_reason)
    egos = pd.read_parquet(folder / "run" / "egos.parquet")
    met = met_people(scenario, egos, read_csv(folder / "run" / "encounters.csv"))
    rows = [plain(TABLE, row_of(TABLE.columns, one)) for one in met]
    write_csv(folder / TABLE.file, TABLE.names(), cells(TABLE, rows))
    signals = any(one.signal for group in found.network.connections.values() for one in group)
    return Driven(folder, outcome, met, signals)
