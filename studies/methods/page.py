"""``python -m studies.methods.page STUDIES PAGE``: what the methods came to, and a table for each condition.

Reads the runs of all studies in a folder and writes below the line ``## What was found`` of the page, which
keeps what stands above it; the picture lies beside the page.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from analysis.errors import StudyError
from analysis.markdown import table, write_below
from analysis.study.design import Condition, Study, read_study
from studies.finished import run_folders
from studies.methods.answer import sentences
from studies.methods.figure import draw
from studies.methods.rows import Row, pooled, rows

FOUND = "## What was found"
FIGURE = "study-papers.png"

_HEADINGS = (
    "method",
    "valid runs",
    "people at once",
    "entered encounters",
    "contacts",
    "preventable",
    "contacts per entered encounter (95 %)",
    "least TTC [s]",
    "TTC < 1.5 s",
    "delay of a trip [s]",
    "jerk, p95 [m/s³]",
    "applies",
    "acts where it applies",
    "overruled",
    "solved",
    "control step, p95 [ms]",
)
_INTRODUCTION = """\
# The methods of the papers in traffic

None of the papers makes this comparison: every method drives through the same streets, past the same
pedestrians and vehicles, on the same seeds, beside methods of today and SUMO's own driver.

    make study-papers

runs the study files of `studies/methods` and writes what stands below. Repeat the command to resume.

*Entered encounters* are those whose pedestrian was on the crossing or in the ego's path, or was touched.
Contacts are computed from recorded shapes, continuously between samples; a contact is *preventable* if the
careful driver of UN R157 would have avoided it. The interval of their share is exact for independent
encounters; those of one run may be correlated. *Least TTC* (time to collision) is the minimum over all runs.
Delay is relative to the speed limit; an unfinished trip counts with its delay so far. *Applies* is the share
of the plans near pedestrians in which the condition holds under which the method's source has it act, *acts
where it applies* the share of those in which the method's own plan is driven, *overruled* the share in which
emergency braking or a fallback has the last word; each controller says so itself ([metrics](metrics.md)).
*Solved* is the share of all plans. Jerk and control step are means over runs of the run's 95th percentile;
the control step is wall-clock time, measured beside other runs.
"""


def markdown(study: Study) -> str:
    """Return the sentences, the picture and all tables."""
    labels = study.all_labels()
    rows_of = {condition: rows(study, condition) for condition in study.conditions}
    whole = {label: pooled(study, label) for label in labels}
    whole = {label: row for label, row in whole.items() if row.runs}
    fewest = min((row.encounters for found in rows_of.values() for row in found), default=0)
    answer = "\n".join(f"{n}. {one}" for n, one in enumerate(sentences(study, whole, fewest), 1))
    picture = (
        f"![contacts per 100 encounters over the delay of a trip, a point a method]({FIGURE})\n\n"
        "*Safety against delay over all conditions, with 95 % intervals: exact ones of the share, Student's "
        "t over runs of the delay.*"
    )
    parts = [answer, picture, "### All conditions\n", table(_HEADINGS, map(_cells, whole.values())) + "\n"]
    return (
        "\n\n".join(parts[:2])
        + "\n\n"
        + "\n".join([*parts[2:], *(_block(condition, found) for condition, found in rows_of.items())])
    )


def write_page(folder: Path, page: Path) -> None:
    """Write what the studies in a folder found into a page, below whatever stands above it, and the picture.

    Raises
    ------
    StudyError
        If there are no runs in the folder, or they cannot be read.
    """
    study = read_study(run_folders(folder))
    if study.unreadable:
        raise StudyError(min(study.unreadable.values()))
    draw(page.parent / FIGURE, study, {label: pooled(study, label) for label in study.all_labels()})
    write_below(page, FOUND, markdown(study), _INTRODUCTION)


def _block(condition: Condition, found: Sequence[Row]) -> str:
    title = f"### {condition.scenario_id}, {condition.text}".rstrip(", ")
    return f"{title}\n\n{table(_HEADINGS, [_cells(row) for row in found])}\n"


def _cells(row: Row) -> list[str]:
    share = f"{row.contacts / row.encounters:.1%}" if row.encounters else ""
    if row.contact_share is not None:
        share += f" ({row.contact_share.low:.1%} … {row.contact_share.high:.1%})"
    return [
        row.method,
        f"{row.valid} of {row.runs}",
        _number(row.people_at_once, ".1f"),
        str(row.encounters),
        f"**{row.contacts}**",
        str(row.preventable),
        share,
        _number(row.least_ttc, ".2f"),
        str(row.short_ttc),
        _number(row.delay, ".1f"),
        _number(row.jerk, ".1f"),
        _number(row.applies, ".0%"),
        _number(row.acts, ".0%"),
        _number(row.overridden, ".1%"),
        _number(row.solved, ".1%"),
        _number(row.control_ms, ".1f"),
    ]


def _number(value: float | None, layout: str) -> str:
    return "" if value is None else format(value, layout)


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except StudyError as problem:
        sys.exit(f"methods: {problem}")
