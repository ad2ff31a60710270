"""``python -m studies.methods.page STUDY PAGE``: one table for each scenario and demand of a study.

Reads the runs in the study's folder and writes below the line ``## Tables`` of the page, which keeps what
stands above it.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from analysis.errors import StudyError
from analysis.markdown import table, write_below
from analysis.study.design import Condition, Study, read_study
from studies.finished import run_folders
from studies.methods.rows import Row, rows

TABLES = "## Tables"

_HEADINGS = (
    "method",
    "valid runs",
    "people at once",
    "entered encounters",
    "contacts",
    "contacts per entered encounter (95 %)",
    "least TTC [s]",
    "TTC < 1.5 s",
    "delay of a trip [s]",
    "jerk, p95 [m/s³]",
    "unsolved steps",
    "control step, p95 [ms]",
)
_INTRODUCTION = """\
# The methods of the papers in traffic

None of the papers makes this comparison: every method drives through the same streets, past the same
pedestrians and vehicles, on the same seeds.

    make study-papers

runs `studies/methods/methods.toml` and writes the tables below. Repeat the command to resume.

*People at once* is the mean number of pedestrians within 45 m of an ego while the ego is within 45 m of a
crossing. *Entered encounters* are those whose pedestrian was on the crossing or in the ego's path, or was
touched. Contacts are computed from recorded shapes, continuously between samples. The interval of their
share is exact for independent encounters; those of one run may be correlated. *Least TTC* (time to
collision) is the minimum over all runs. Delay is relative to the speed limit; an unfinished trip counts with
its delay so far. Jerk and control step are means over runs of the run's 95th percentile. The control step is
wall-clock time, measured beside other runs.
"""


def markdown(study: Study) -> str:
    """Return all tables."""
    blocks = [_block(condition, rows(study, condition)) for condition in study.conditions]
    return "\n".join(blocks)


def write_page(folder: Path, page: Path) -> None:
    """Write the tables of a study into a page, below whatever stands above them.

    Raises
    ------
    StudyError
        If there are no runs in the folder, or they cannot be read.
    """
    study = read_study(run_folders(folder))
    if study.unreadable:
        raise StudyError(min(study.unreadable.values()))
    write_below(page, TABLES, markdown(study), _INTRODUCTION)


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
        share,
        _number(row.least_ttc, ".2f"),
        str(row.short_ttc),
        _number(row.delay, ".1f"),
        _number(row.jerk, ".1f"),
        str(row.unsolved),
        _number(row.control_ms, ".1f"),
    ]


def _number(value: float | None, layout: str) -> str:
    return "" if value is None else format(value, layout)


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except StudyError as problem:
        sys.exit(f"methods: {problem}")
