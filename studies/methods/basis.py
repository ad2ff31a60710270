"""The section on what a page of the methods rests on: how much of the whole study has been run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from analysis.markdown import table
from analysis.study.design import Condition, Study
from studies.methods.answer import ENOUGH, counted, seeds_of
from studies.methods.rows import Row, title


def basis(study: Study, rows_of: Mapping[Condition, Sequence[Row]], planned: Mapping[str, int]) -> str:
    """Return the section: the command, how much of it was run, and how large the cells are.

    Parameters
    ----------
    study : the runs of conditions and seeds that all methods drove
    rows_of : the rows of each condition
    planned : number of runs of each batch of the whole study, by its folder; empty if it is not known
    """
    seeds = sorted({run.seed for run in study.runs})
    cells = [row for found in rows_of.values() for row in found]
    enough = sum(row.encounters >= ENOUGH for row in cells)
    lines = [
        "## What it rests on\n",
        "<!-- no-run: drives the whole study; tests/studies/test_methods.py makes a smaller page -->\n",
        "    make study-papers\n",
        "runs the study files of `studies/methods` and writes this page. Repeat the command to resume. It "
        "runs seed by seed, within a seed level by level of demand (busy, light, crowded), within a level "
        "scenario by scenario; the page counts what every method drove: it may be stopped at any time. "
        "[The table of its runs](study-papers.csv) is what the page is made of; with `--seeds` others can be "
        "added to it.\n",
        f"This page counts {counted(len(study.runs), sum(planned.values()))} "
        f"(seeds {', '.join(map(str, seeds))}; {len(study.all_labels())} methods). Of the {len(cells)} "
        f"cells, a method under a condition, {enough} have {ENOUGH} entered encounters or more. "
        f"{_code(study)}\n",
        table(("condition", "seeds", "entered encounters of a cell"), _conditions(study, rows_of)),
    ]
    return "\n".join(lines) + "\n"


def _code(study: Study) -> str:
    """Say which commits drove which seeds."""
    seeds: dict[str, set[int]] = {}
    for run in study.runs:
        seeds.setdefault(run.versions[:7] or "an unknown commit", set()).add(run.seed)
    told = (f"{', '.join(map(str, sorted(some)))} by {code}" for code, some in sorted(seeds.items()))
    return f"Driven: {'; '.join(told)}."


def _conditions(study: Study, rows_of: Mapping[Condition, Sequence[Row]]) -> list[list[str]]:
    seeds = seeds_of(study)
    return [
        [
            title(study, one),
            str(seeds[one.condition_id]),
            f"{min(row.encounters for row in found)} to {max(row.encounters for row in found)}",
        ]
        for one, found in rows_of.items()
    ]
