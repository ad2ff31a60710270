"""The encounters that a report lists, and their replays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from analysis.errors import RecordingError
from analysis.page import origin, town
from analysis.page.encounters import (
    OF_EGOS,
    OF_TRAFFIC,
    SEVERITIES,
    Encounters,
    Found,
    Listing,
    pick,
    read_encounters,
    worst_first,
)
from analysis.page.recorded import Recording, has_recording, read_recording, read_traffic_recording
from analysis.page.replay import replay_of, replay_of_ego, write_replay
from analysis.study.design import Study
from analysis.study.runs import StudyRun

OF_EACH = 20
"""This many of the worst encounters of each configuration are listed, however good it is."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A moment of an ego without an encounter, such as the beginning of a deadlock."""

    run: StudyRun
    key: str
    """Name of the replay."""
    ego_id: str
    moment_s: float


@dataclass(frozen=True, slots=True)
class Listed:
    """The part of all encounters that the report lists."""

    table: Listing
    found: Encounters
    rows: Sequence[Found]
    """The listed encounters, the worst first."""
    of_crossings: Mapping[str, Sequence[Found]]
    """The worst encounters of each crossing of a screening; ``rows`` contains them too."""
    accused: Mapping[tuple[str, int], str]
    """Replays of the encounters that failed criteria are about, by run and number; ``rows`` has them too."""
    moments: Mapping[tuple[str, str, float], Moment]
    """Moments of egos that failed criteria are about, by run, ego and time."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """Replays that were written, and those that could not be written."""

    keys: set[str]
    problems: Mapping[str, str]
    """What went wrong, by the name of the replay."""
    damaged: Mapping[Path, str]
    """What went wrong, by run folder."""


def choose(
    study: Study, root: Path | None, criteria: Mapping[str, Any] | None, *, of_town: bool, rows: int
) -> Listed:
    """Return what to list: the worst encounters, and those that criteria and crossings are about.

    Parameters
    ----------
    study
        The runs.
    root
        Folder of the check to which the criteria belong.
    criteria
        As returned by :func:`analysis.page.origin.criteria`.
    of_town
        Whether the runs belong to a screening.
    rows
        Number of the worst encounters to list.
    """
    table = OF_TRAFFIC if of_town or _without_egos(study) else OF_EGOS
    found = read_encounters(study, table)
    order = worst_first(found)
    worst = town.worst_of_each(found, order) if of_town else {}
    accused = _accused(criteria, root, found)
    chosen = {*pick(order, found, study, rows, OF_EACH), *accused.values()}
    chosen |= {row for some in worst.values() for row in some}
    return Listed(
        table,
        found,
        [found.at(row) for row in order if row in chosen],
        {name: [found.at(row) for row in some] for name, some in worst.items()},
        {where: found.at(row).key for where, row in accused.items()},
        _moments(criteria, root, study),
    )


def _without_egos(study: Study) -> bool:
    """Return whether everybody was recorded but there was no ego, so that the traffic itself was judged."""
    valid = [run for run in study.runs if run.valid]
    return bool(valid) and all(
        not run.numbers.get("ego_count") and (run.folder / OF_TRAFFIC.file).is_file() for run in valid
    )


def replay(listed: Listed, folder: Path, most: int) -> Replayed:
    """Write the replays of the worst encounters and of moments that have a recording; remove old replays.

    Parameters
    ----------
    listed
        What is listed. The encounters that criteria and crossings are about come first.
    folder
        Folder for the files.
    most
        Largest number of encounters with a replay.
    """
    for old in folder.glob("*.js") if folder.is_dir() else ():
        old.unlink()
    first = {*listed.accused.values(), *(one.key for some in listed.of_crossings.values() for one in some)}
    rows = sorted(listed.rows, key=lambda one: one.key not in first)
    recorded = {path: has_recording(path) for path in {one.run.folder for one in rows}}
    chosen: list[Found | Moment] = [*[one for one in rows if recorded[one.run.folder]][:most]]
    chosen += [one for one in listed.moments.values() if has_recording(one.run.folder)]
    read = read_recording if listed.table is OF_EGOS else read_traffic_recording
    done: set[str] = set()
    problems: dict[str, str] = {}
    damaged: dict[Path, str] = {}
    for place, group in groupby(
        sorted(chosen, key=lambda one: str(one.run.folder)), lambda one: one.run.folder
    ):
        mine = list(group)
        try:
            _write(mine, read(place), folder)
            done |= {one.key for one in mine}
        except RecordingError as error:
            problems |= {one.key: str(error) for one in mine}
            damaged[place] = str(error)
    return Replayed(done, problems, damaged)


def _write(chosen: Iterable[Found | Moment], recording: Recording, folder: Path) -> None:
    for one in chosen:
        if isinstance(one, Moment):
            write_replay(one.key, replay_of_ego(recording, one.ego_id, one.moment_s), folder)
        else:
            write_replay(one.key, replay_of(recording, one.number), folder)


def _accused(
    criteria: Mapping[str, Any] | None, root: Path | None, found: Encounters
) -> dict[tuple[str, int], int]:
    """Return the rows of the encounters that failed criteria are about, by run and number in criteria.csv."""
    rows = _failed(criteria)
    wanted = {(one["run"], one["encounter_id"]) for one in rows if one["run"] and one["encounter_id"]}
    if root is None or not wanted:
        return {}
    places = {
        (run.folder.resolve(), int(number)): row
        for row, (owner, number) in enumerate(zip(found.owner, found.numbers["encounter_id"], strict=True))
        for run in (found.runs[int(owner)],)
    }
    known = {one: places.get(((root / one[0]).resolve(), one[1])) for one in sorted(wanted)}
    return {one: row for one, row in known.items() if row is not None}


def _moments(
    criteria: Mapping[str, Any] | None, root: Path | None, study: Study
) -> dict[tuple[str, str, float], Moment]:
    """Return the moments of egos that failed criteria are about."""
    if root is None:
        return {}
    runs = {run.folder.resolve(): run for run in study.runs if run.valid}
    found: dict[tuple[str, str, float], Moment] = {}
    for row in _failed(criteria):
        where = row["run"], row["ego_id"], row["moment_s"]
        if None in where or row["encounter_id"] is not None or where in found:
            continue
        run = runs.get((root / row["run"]).resolve())
        if run is not None:
            found[where] = Moment(
                run, f"{run.run_id}-moment-{len(found) + 1}", row["ego_id"], row["moment_s"]
            )
    return found


def _failed(criteria: Mapping[str, Any] | None) -> list[Mapping[str, Any]]:
    return [] if criteria is None else [one for one in criteria["rows"] if one["status"] == "fail"]


def line(one: Found, study: Study, out: Path, replayed: Replayed) -> dict[str, Any]:
    """Return one row of the table of encounters."""
    run = one.run
    condition = next(found for found in study.conditions if found.condition_id == run.condition_id)
    if one.key in replayed.keys:
        state = "replay"
    elif one.key in replayed.problems:
        state = "broken"
    else:
        state = "more" if has_recording(run.folder) else "unrecorded"
    return {
        **one.values,
        "key": one.key,
        "rank": SEVERITIES.index(one.values["severity"]),
        "label": study.label(run),
        "scenario": run.scenario_id,
        "condition": condition.text,
        "seed": run.seed,
        "run_id": run.run_id,
        "folder": relative_name(run.folder, out),
        "number": one.number,
        "contact": one.contact,
        "moment_s": one.moment_s,
        "state": state,
        "problem": replayed.problems.get(one.key, ""),
    }


def relative_name(folder: Path, out: Path) -> str:
    """Return the path of a run folder relative to the report; ``this folder`` for the report's own."""
    name = origin.relative(folder, out)
    return "this folder" if name == "." else name
