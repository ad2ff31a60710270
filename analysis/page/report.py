"""Writes ``report.html``, a single file that opens from disk, and the data of replays beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from analysis.errors import StudyError
from analysis.files import write_text
from analysis.page import origin, tables, town
from analysis.page.distributions import distributions
from analysis.page.encounters import OF_EGOS, SEVERITIES, Encounters
from analysis.page.facts import rows_of_tiles
from analysis.page.listed import Listed, Replayed, choose, line, replay
from analysis.page.names import DATA, PAGE, REPLAYS
from analysis.page.recorded import has_recording
from analysis.page.terms import definitions, known_measures, linked, terms
from analysis.results.measures import Measure, run_measures
from analysis.study.design import Study, read_study
from analysis.study.runs import StudyRun, find_run_folders
from analysis.study.seeds_needed import MEANING
from analysis.validation.statement import SENTENCE

REAL = "tracks"
"""Controller of recordings of real traffic."""

PRINTED = {"criteria": 40, "encounters": 30, "crossings": 10}
"""Rows of long tables on paper; below each table, the page says how many are missing and where they are."""

Say = Callable[[Sequence[Mapping[str, Any]], Mapping[str, Measure]], str]
"""Makes a sentence from the rows of one comparison."""


@dataclass(frozen=True, slots=True)
class Written:
    """What was written."""

    page: Path
    replays: int
    """Number of listed encounters with a replay."""
    listed: int
    not_recorded: int
    """Number of listed encounters without a recording."""
    runs: Sequence[StudyRun]
    unreadable: Mapping[Path, str]
    """Runs that are left out or have no replay because a file was altered or lost, with the file and the
    remedy."""


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
        Folder for ``report.html`` and ``report_data``; existing ones are replaced.
    say
        Makes the sentence of a comparison.
    title
        Title of the page.
    baseline
        As for :func:`analysis.study.writing.write_tables`.
    rows, replays
        Numbers of the worst encounters that are listed, and that have a replay.

    Raises
    ------
    StudyError
        If there is no run or none of the baseline, or if runs cannot be read or do not belong together.
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
    criteria = origin.criteria(root)
    # A failed run that recorded something is a run of the study, too: failed/NAME/run.
    recorded = {run.folder.parent.name for run in study.runs if not run.valid}
    failed = [row for row in origin.failed_runs(root) if row["run"] not in recorded]
    listed = choose(study, root, criteria, of_town=screened is not None, rows=rows)
    replayed = replay(listed, data / REPLAYS, replays)
    found = listed.found
    content = (
        environment()
        .get_template("page.html.jinja")
        .render(
            title=title or out.resolve().name,
            question=_question(study, baseline) if screened is None else _question_of_town(study),
            answers=_answers(study, made, say, found) if screened is None else town.answers(screened),
            town=screened,
            valid=f"{len(found.runs)} of {len(study.runs) + len(failed)}",
            facts=rows_of_tiles(study, found, listed.table),
            criteria=criteria,
            failed=[*failed, *origin.damaged_runs(study, out)],
            tables_folder=_prefix(origin.relative(made.folder, out)),
            distributions=distributions(study, found) if screened is None else [],
            replays=f"{DATA}/{REPLAYS}",
            print=PRINTED,
            **_encounters(listed, replayed, study, out),
            **_measures(made, criteria, of_town=screened is not None),
            **_origin(study, root, out),
        )
    )
    path = write_text(out / PAGE, content)
    missing = sum(not has_recording(one.run.folder) for one in listed.rows)
    damaged = {**study.unreadable, **replayed.damaged}
    shown = sum(one.key in replayed.keys for one in listed.rows)
    return Written(path, shown, len(listed.rows), missing, study.runs, damaged)


def _encounters(listed: Listed, replayed: Replayed, study: Study, out: Path) -> dict[str, Any]:
    """Return what the page shows about encounters."""
    return {
        "listing": listed.table,
        "of_egos": listed.table is OF_EGOS,
        "encounters": [line(one, study, out, replayed) for one in listed.rows],
        "total": len(listed.found),
        "worst": listed.of_crossings,
        "accused": listed.accused,
        "moments": listed.moments,
        "replayed": replayed.keys,
        "severities": SEVERITIES,
    }


def _measures(made: tables.Tables, criteria: Mapping[str, Any] | None, *, of_town: bool) -> dict[str, Any]:
    """Return what the page shows about configurations and comparisons, and what the measures mean."""
    blocks = tables.configuration_blocks(made.configs)
    compared = tables.comparison_blocks(made.comparisons)
    measured = {line["metric"] for block in (*blocks, *compared) for line in block["lines"]}
    measured |= known_measures() & {one["metric"] for one in (criteria or {}).get("rows", ())}
    return {
        "blocks": blocks,
        "comparisons": compared,
        "seeds_meaning": MEANING,
        "terms": terms(),
        "measured": measured,
        "definitions": definitions(() if of_town else measured),
    }


def _origin(study: Study, root: Path | None, out: Path) -> dict[str, Any]:
    """Return what the page says about the runs and how they were made."""
    return {
        "runs": origin.run_lines(study, out),
        "controllers": study.all_labels(),
        "scenarios": sorted({run.scenario_id for run in study.runs}),
        "simulated": any(run.controller != REAL for run in study.runs),
        "validation": SENTENCE,
        "made": origin.made_with(study, root),
    }


@cache
def environment() -> Environment:
    """Return the environment that fills the templates of this package and compiles each of them once."""
    found = Environment(
        loader=PackageLoader("analysis.page", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    found.filters["terms"] = linked
    # Inserts files into the page unescaped; </ would end the surrounding element.
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
    """Return one sentence for each scenario and pair of configurations, over all settings of the scenario."""
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
        f"{len(found)} encounter{'s' * (len(found) != 1)} in {runs} valid run{'s' * (runs != 1)}, "
        f"{entered} of them entered: "
        f"{collisions or 'no'} collision{'s' * (collisions != 1)}, "
        f"smallest time to collision (TTC) {'undefined' if ttc is None else f'{ttc:.2f} s'}, "
        f"smallest distance {'undefined' if distance is None else f'{distance:.2f} m'}."
    ]


def _smallest(found: Encounters, column: str) -> float | None:
    values = found.numbers[column]
    known = values[np.isfinite(values)]
    return float(known.min()) if len(known) else None


def _prefix(folder: str) -> str:
    return "" if folder == "." else f"{folder}/"
