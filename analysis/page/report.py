"""Writes ``report.html``: one file that opens from disk, and the data of replays beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from analysis.errors import RecordingError, StudyError
from analysis.files import write_text
from analysis.page import origin, tables, town
from analysis.page.distributions import distributions
from analysis.page.encounters import (
    OF_EGOS,
    OF_TRAFFIC,
    SEVERITIES,
    Encounters,
    Found,
    pick,
    read_encounters,
    worst_first,
)
from analysis.page.facts import rows_of_tiles
from analysis.page.names import DATA, PAGE, REPLAYS
from analysis.page.replay import (
    Recording,
    has_recording,
    read_recording,
    read_traffic_recording,
    write_replays,
)
from analysis.page.terms import definitions, known_measures, linked, terms
from analysis.results.measures import Measure, run_measures
from analysis.study.design import Study, read_study
from analysis.study.runs import StudyRun, find_run_folders
from analysis.study.seeds_needed import MEANING
from analysis.validation.statement import SENTENCE

REAL = "tracks"
"""Controller of recordings of real traffic."""
OF_EACH = 20
"""So many of the worst encounters of each configuration are listed, however good it is."""

Say = Callable[[Sequence[Mapping[str, Any]], Mapping[str, Measure]], str]
"""Makes a sentence of the rows of one comparison."""


@dataclass(frozen=True, slots=True)
class Written:
    """Files that were written."""

    page: Path
    replays: int
    listed: int
    not_recorded: int
    """Listed encounters without a recording."""
    runs: Sequence[StudyRun]
    unreadable: Mapping[Path, str]
    """Runs that are left out or have no replay because a file was altered or lost: which, and what can be
    done."""


def write_report(
    roots: Sequence[Path],
    out: Path,
    say: Say,
    *,
    title: str = "",
    baseline: str | None = None,
    rows: int = 200,
    replays: int = 100,
) -> Written:
    """Write the report of the runs at or below some folders.

    Parameters
    ----------
    roots
        Run folders, or folders with run folders in them.
    out
        Folder for ``report.html`` and ``report_data``; what is there of these is replaced.
    say
        Makes the sentence of a comparison.
    title
        Of the page.
    baseline
        As :func:`analysis.study.writing.write_tables`.
    rows, replays
        So many of the worst encounters are listed, and have a replay.

    Raises
    ------
    StudyError
        When there is no run, none of the baseline, or runs cannot be read or do not belong together.
    """
    folders = list(dict.fromkeys(folder for root in roots for folder in find_run_folders(root)))
    if not folders:
        raise StudyError(f"{', '.join(map(str, roots))}: no run in it; cosim run and cosim batch make them")
    study = read_study(folders)
    if baseline is not None and not study.matching(baseline):
        raise StudyError(f"{baseline}: no run of it; there are {', '.join(study.all_labels())}")
    root = roots[0] if len(roots) == 1 else None
    data = out / DATA
    data.mkdir(parents=True, exist_ok=True)
    made = tables.study_tables(study, root, data, folders, baseline)
    screened = town.screening(root, study.runs)
    listing = OF_EGOS if screened is None and not _without_egos(study) else OF_TRAFFIC
    found = read_encounters(study, listing)
    order = worst_first(found)
    worst = {} if screened is None else town.worst_of_each(found, order)
    criteria = origin.criteria(root)
    accused = _accused(criteria, root, found)
    of_places = {row for some in worst.values() for row in some} | {*accused.values()}
    chosen = of_places | {*pick(order, found, study, rows, OF_EACH)}
    listed = [found.at(row) for row in order if row in chosen]
    first = {found.at(row).key for row in of_places}
    replayed, problems, damaged = _replays(
        sorted(listed, key=lambda one: one.key not in first),
        data / REPLAYS,
        replays,
        read_recording if listing is OF_EGOS else read_traffic_recording,
    )
    lines = origin.run_lines(study, out)
    blocks, compared = tables.configuration_blocks(made.configs), tables.comparison_blocks(made.comparisons)
    measured = {line["metric"] for block in (*blocks, *compared) for line in block["lines"]}
    measured |= known_measures() & {one["metric"] for one in (criteria or {}).get("rows", ())}
    page = environment().get_template("page.html.jinja")
    content = page.render(
        title=title or out.resolve().name,
        question=_question(study, baseline) if screened is None else _question_of_town(study),
        answers=_answers(study, made, say, found) if screened is None else town.answers(screened),
        town=screened,
        of_egos=listing is OF_EGOS,
        simulated=any(run.controller != REAL for run in study.runs),
        validation=SENTENCE,
        worst={name: [found.at(row) for row in some] for name, some in worst.items()},
        replayed=replayed,
        valid=f"{len(found.runs)} of {len(study.runs) + len(origin.failed_runs(root))}",
        facts=rows_of_tiles(study, found, listing),
        criteria=criteria,
        accused={where: found.at(row).key for where, row in accused.items()},
        failed=[*origin.failed_runs(root), *origin.damaged_runs(study, out)],
        runs=lines,
        blocks=blocks,
        comparisons=compared,
        seeds_meaning=MEANING,
        tables_folder=_prefix(origin.relative(made.folder, out)),
        distributions=distributions(study, found) if screened is None else [],
        listing=listing,
        encounters=[_line(one, study, out, replayed, problems) for one in listed],
        total=len(found),
        controllers=study.all_labels(),
        scenarios=sorted({run.scenario_id for run in study.runs}),
        severities=SEVERITIES,
        terms=terms(),
        measured=measured,
        definitions=definitions(measured if screened is None else ()),
        made=origin.made_with(study, root),
        replays=f"{DATA}/{REPLAYS}",
    )
    path = write_text(out / PAGE, content)
    missing = sum(not has_recording(one.run.folder) for one in listed)
    return Written(path, len(replayed), len(listed), missing, study.runs, {**study.unreadable, **damaged})


def environment() -> Environment:
    """Return what fills the templates of this package."""
    found = Environment(
        loader=PackageLoader("analysis.page", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    found.filters["terms"] = linked
    # Raw texts of the page itself; </ would end the element they stand in.
    folder = Path(__file__).parent
    found.globals["source"] = lambda name: (folder / name).read_text("utf-8").replace("</", "<\\/")
    return found


def _question(study: Study, baseline: str | None) -> str:
    scenarios = ", ".join(sorted({run.scenario_id for run in study.runs}))
    pairs = study.pairs_of_labels(baseline)
    if not pairs:
        return f"How safe is {study.all_labels()[0]} on {scenarios}?"
    bases, others = ([*dict.fromkeys(pair[side] for pair in pairs)] for side in (0, 1))
    verb = "Is" if len(others) == 1 else "Are"
    return f"{verb} {_listed(others)} safer than {_listed(bases)} on {scenarios}, and slower?"


def _question_of_town(study: Study) -> str:
    scenarios = ", ".join(sorted({run.scenario_id for run in study.runs}))
    return f"Which crossings of {scenarios} are dangerous?"


def _listed(names: Sequence[str]) -> str:
    if len(names) > 5:
        return f"{len(names)} configurations"
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _answers(study: Study, made: tables.Tables, say: Say, found: Encounters) -> list[str]:
    """Return one sentence for each pair of configurations and scenario, over all its settings."""
    by_name = {measure.name: measure for measure in run_measures()}
    scopes: dict[tuple[str, str, str], list[Mapping[str, Any]]] = {}
    keyed = [row for row in made.comparisons if row["key"]]
    for (scenario, _, base, alt), group in groupby(
        keyed, key=lambda row: (row["scenario_id"], row["condition_id"], row["base"], row["alt"])
    ):
        scopes[scenario, base, alt] = list(group)  # the last one is over all conditions
    told = [say(rows, by_name) for rows in scopes.values() if max(row["n_pairs"] for row in rows) > 0]
    if told or made.comparisons:
        return told or ["No comparison is possible: no pair of valid runs has the same seed."]
    if len(found) == 0:
        return ["No statement on safety is possible: no valid run has an encounter."]
    hit = np.array(found.texts["severity"]) == "collision"
    collisions, entered = int(hit.sum()), int(((found.numbers["entered"] == 1.0) | hit).sum())
    runs = len(found.runs)
    ttc, distance = _smallest(found, "min_ttc_s"), _smallest(found, "min_dist_m")
    return [
        f"{len(found)} encounters in {runs} valid run{'s' * (runs != 1)}, {entered} of them entered: "
        f"{collisions or 'no'} collision{'s' * (collisions != 1)}, "
        f"smallest time to collision (TTC) {'undefined' if ttc is None else f'{ttc:.2f} s'}, "
        f"smallest distance {'undefined' if distance is None else f'{distance:.2f} m'}."
    ]


def _smallest(found: Encounters, column: str) -> float | None:
    values = found.numbers[column]
    known = values[np.isfinite(values)]
    return float(known.min()) if len(known) else None


def _replays(
    listed: Sequence[Found], folder: Path, most: int, read: Callable[[Path], Recording]
) -> tuple[set[str], dict[str, str], dict[Path, str]]:
    """Write the replays of the worst encounters that have a recording.

    Return their keys, and what went wrong by key and by run.
    """
    for old in folder.glob("*.js") if folder.is_dir() else ():
        old.unlink()
    recorded = {path: has_recording(path) for path in {one.run.folder for one in listed}}
    chosen = [one for one in listed if recorded[one.run.folder]][:most]
    done: set[str] = set()
    problems: dict[str, str] = {}
    damaged: dict[Path, str] = {}
    for place, group in groupby(
        sorted(chosen, key=lambda one: str(one.run.folder)), lambda one: one.run.folder
    ):
        mine = list(group)
        try:
            write_replays(read(place), [(one.number, one.key) for one in mine], folder)
            done |= {one.key for one in mine}
        except RecordingError as error:
            problems |= {one.key: str(error) for one in mine}
            damaged[place] = str(error)
    return done, problems, damaged


def _accused(
    criteria: Mapping[str, Any] | None, root: Path | None, found: Encounters
) -> dict[tuple[str, int], int]:
    """Return the encounters that failed criteria are about: run and number of criteria.csv, to row."""
    rows = [] if criteria is None else [one for one in criteria["rows"] if one["status"] == "fail"]
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


def _line(
    one: Found, study: Study, out: Path, replayed: set[str], problems: Mapping[str, str]
) -> dict[str, Any]:
    """Return one row of the table of encounters."""
    run = one.run
    condition = next(found for found in study.conditions if found.condition_id == run.condition_id)
    if one.key in replayed:
        state = "replay"
    elif one.key in problems:
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
        "problem": problems.get(one.key, ""),
    }


def _without_egos(study: Study) -> bool:
    """Return whether everybody was recorded and nobody is an ego, so that the traffic is what was judged."""
    valid = [run for run in study.runs if run.valid]
    return bool(valid) and all(
        not run.numbers.get("ego_count") and (run.folder / OF_TRAFFIC.file).is_file() for run in valid
    )


def _prefix(folder: str) -> str:
    return "" if folder == "." else f"{folder}/"


def relative_name(folder: Path, out: Path) -> str:
    """Return a run folder as seen from the report; ``this folder`` for the report's own."""
    name = origin.relative(folder, out)
    return "this folder" if name == "." else name
