"""Estimates types of road users from one part of a recording, and validates them on the other part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from analysis.errors import AnalysisError
from analysis.files import write_csv, write_text
from analysis.tables.cells import Row, cells, plain
from analysis.tables.column import Table, count, number, row_of, text
from analysis.validation.estimate import Estimate
from analysis.validation.estimators import estimates
from analysis.validation.observed import observe
from cosim.errors import InputError
from cosim.recording import folders
from cosim.recording.folders import DEFAULT_PARENT
from cosim.tracks.judging import OnNetwork, TracksRequest, read_on_network, write_judged
from cosim.tracks.nearness import near_crossings
from cosim.validation.demand import Types
from cosim.validation.site import read_site
from cosim.validation.span import spanned
from cosim.validation.types_file import types_text
from cosim.validation.validate import ValidationRequest

TRAINING, BEFORE, AFTER, WORK = "training", "before", "after", "network"
"""Folders of a calibration."""
FILE = "calibrated.toml"
CAR = {"accel": "acceleration", "decel": "braking", "tau": "time_gap", "minGap": "standstill_gap"}
"""Attributes of SUMO's type of cars, and the estimates that give their values."""

ESTIMATES = Table(
    "estimates",
    "One row for each parameter: what was estimated from the first part of the recording",
    (
        text("parameter", "what was estimated", source="name", required=True),
        text("unit", "of the row's numbers", source="unit", required=True),
        number("value", "1", "estimate; empty where the tracks cannot tell", source="value"),
        number("value_lo", "1", "95 % interval over road users", source="low"),
        number("value_hi", "1", "95 % interval over road users", source="high"),
        count("n", "road users", source="n", required=True),
        text("method", "how it was estimated, or why not", source="method", required=True),
    ),
    ("parameter",),
)


@dataclass(frozen=True, slots=True)
class CalibrationRequest:
    """A user's request for a calibration."""

    scenario: str
    tracks: str
    split_s: float | None = None
    """Time in the recording at which the held-out part begins; ``None`` for the middle [s]."""
    out: Path | None = None
    crs: str | None = None
    bodies: str | None = None

    @property
    def folder(self) -> Path:
        """Folder of the calibration."""
        return DEFAULT_PARENT / f"calibrate-{Path(self.scenario).stem}" if self.out is None else self.out


@dataclass(frozen=True, slots=True)
class Calibrated:
    """Result of a calibration."""

    folder: Path
    file: Path
    estimates: Mapping[str, Estimate]
    split_s: float
    end_s: float


def calibrated(request: CalibrationRequest) -> Calibrated:
    """Estimate parameters from the first part of a recording, and write them as types of road users.

    Raises
    ------
    InputError
        If the scenario or the tracks are invalid.
    """
    folder = request.folder
    folders.check(folder)
    with folders.left_as_it_was(folder, folder.is_dir()):
        return _calibrated(request)


def _calibrated(request: CalibrationRequest) -> Calibrated:
    folder = request.folder
    site = read_site(request.scenario, folder / WORK)
    tracks = TracksRequest(request.tracks, site.net_file, request.crs, request.bodies)
    found = read_on_network(tracks)
    end = float(found.placed.frame["time_s"].max())
    split = 0.5 * end if request.split_s is None else request.split_s
    if not 0.0 < split < end:
        raise InputError(
            f"--split {split:g}: expected a second within the recording, which ends at {end:g} s"
        )
    known = _estimated(folder / TRAINING, tracks, found, split)
    types, comments = types_of(known)
    write_csv(folder / ESTIMATES.file, ESTIMATES.names(), cells(ESTIMATES, _rows(known)))
    head = (
        f"# Estimated by cosim calibrate from {Path(request.tracks).name}, seconds 0 to {split:g};\n"
        "# intervals are 95 %, n counts road users. What is not here could not be estimated.\n\n"
    )
    file = write_text(folder / FILE, head + types_text(types, comments))
    return Calibrated(folder, file, known, split, end)


def _estimated(folder: Path, tracks: TracksRequest, found: OnNetwork, split: float) -> Mapping[str, Estimate]:
    frame = spanned(found.placed.frame, (0.0, split), found.step_s)
    if frame.empty:
        raise InputError(f"{tracks.tracks}: nobody appears before {split:g} s")
    folder.mkdir(parents=True)
    frame = near_crossings(frame, found.network) if found.network.crossings else frame
    try:
        write_judged(folder, tracks, found, frame)
        return estimates(observe(folder))
    except AnalysisError as error:
        raise InputError(str(error)) from error


def _rows(known: Mapping[str, Estimate]) -> list[Row]:
    return [plain(ESTIMATES, row_of(ESTIMATES.columns, one)) for one in known.values()]


def types_of(known: Mapping[str, Estimate]) -> tuple[Types, Mapping[str, str]]:
    """Return estimates as attributes of SUMO's types, and a comment on each by ``class.attribute``."""
    types: dict[str, dict[str, str]] = {}
    comments: dict[str, str] = {}

    def put(kind: str, attribute: str, value: str, *sources: str) -> None:
        types.setdefault(kind, {})[attribute] = value
        comments[f"{kind}.{attribute}"] = "; ".join(_comment(known[name]) for name in sources)

    if known["walking_speed"].known:
        speed, spread = known["walking_speed"].value, known["walking_speed_sd"].value
        put("pedestrian", "desiredMaxSpeed", f"{speed:.3f}", "walking_speed")
        put("pedestrian", "speedFactor", f"normc(1,{spread / speed:.3f},0.5,1.8)", "walking_speed_sd")
    # Near a junction, hardly any driver reaches the desired speed, so its estimate is not used.
    for attribute, name in CAR.items():
        if known[name].known:
            put("car", attribute, f"{known[name].value:.3f}", name)
    return types, comments


def _comment(one: Estimate) -> str:
    return (
        f"{one.name} {one.value:.3g} {one.unit} ({one.low:.3g} to {one.high:.3g}), n = {one.n}, {one.method}"
    )


def held_out(
    request: CalibrationRequest, done: Calibrated, seeds: str, jobs: int | None
) -> tuple[ValidationRequest, ValidationRequest]:
    """Return the validations of the held-out part, with SUMO's own types and with the calibrated ones."""

    def of(name: str, types: Path | None) -> ValidationRequest:
        return ValidationRequest(
            request.scenario,
            request.tracks,
            seeds,
            done.folder / name,
            jobs,
            request.crs,
            request.bodies,
            types,
            (done.split_s, done.end_s),
        )

    return of(BEFORE, None), of(AFTER, done.file)
