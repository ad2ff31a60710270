"""``python -m studies.methods.page STUDIES PAGE``: the results of the methods, in total and by condition.

Reads the runs of all studies in a folder, whether they are complete or were stopped. Adds the runs in the
table beside the page that were driven elsewhere under the same conditions. Writes that table with all of
these runs, and from it the page and its figure: the answer, what it rests on, and the tables.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from analysis.errors import StudyError
from analysis.files import write_text
from analysis.markdown import table
from analysis.statistics.paired import Comparison
from analysis.study.design import Condition, Study, study_of_runs
from analysis.wording import p_value
from studies.methods.__main__ import PLAN
from studies.methods.against import MARGIN, OURS, Against, against, differences
from studies.methods.answer import sentences
from studies.methods.basis import basis
from studies.methods.figure import draw
from studies.methods.people import NEAR_M
from studies.methods.rows import Row, balanced, pooled, rows, title
from studies.methods.table import driven, merged, read_table, write_table

FIGURE = "study-papers.png"
VARIANTS, MIDBLOCK = "rules_as_printed", "midblock_zebra"
"""The study of a variant of one method, and the study on the same streets."""

_HEADINGS = (
    "method",
    "valid runs",
    "people at once",
    "entered encounters",
    "contacts",
    "preventable",
    "contacts per entered encounter (95 %)",
    "least time to collision (TTC) [s]",
    "TTC < 1.5 s",
    "delay of a trip [s]",
    "jerk, p95 [m/s³]",
    "applies",
    "acts where it applies",
    "overridden",
    "solved",
    "control step, p95 [ms]",
)
_AGAINST = (
    "method",
    "delay [s] (95 %)",
    "p",
    "jerk, p95 [m/s³] (95 %)",
    "p",
    f"preventable contacts per 100, `{OURS}` minus the method",
    "upper bound",
    "ours non-inferior",
)
_TITLE = """\
# The methods of the papers in traffic

None of the papers makes this comparison: every method drives through the same streets, past the same
pedestrians and vehicles, on the same seeds, beside methods of today and SUMO's own driver. What was tried
beyond it stands in [the methods at work](methods-at-work.md).
"""
_PICTURE = f"""\
![contacts per 100 encounters over the delay against {OURS}, one point per method]({FIGURE})

*Safety against delay over all conditions, with 95 % intervals: exact ones of the share of contacts, and those
of the paired difference of delays.*
"""
_HOW = f"""\
## How it was counted

*People at once* is the mean number of pedestrians within {NEAR_M:g} m of an ego that is near a crossing.
*Entered encounters* are those whose pedestrian was on the crossing or in the ego's path, or was touched.
*Contacts* are entered encounters with a contact while the ego moved, computed from recorded shapes,
continuously between samples; one is *preventable* if the careful driver of UN R157 would have avoided its
first contact. The interval of their share is exact for independent encounters; those of one run may be
correlated. *Least TTC* is the minimum over all runs. Delay is relative to the speed limit; an unfinished trip
counts with its delay so far. *Delay of a trip* is the mean over all egos, so conditions with many egos weigh
more; the differences weigh every condition and seed equally, so the two may have opposite signs. *Applies* is
the share of the plans near pedestrians in which the condition holds under which the method's source has it
act, *acts where it applies* the share of those in which the method's own plan is driven, *overridden* the
share in which emergency braking or a fallback has the last word; each controller says so itself
([metrics](metrics.md)). *Solved* is the share of all plans. Jerk and control step are means over runs of the
run's 95th percentile; the control step is wall-clock time, measured beside other runs.

Differences of delay and jerk are those of runs of the same condition and seed; their p-values have Holm's
correction over the methods, those of single conditions (marked `*` from 5 % down) control the false discovery
rate over all methods and conditions (Benjamini and Hochberg). The bound of the difference of preventable
contacts is Newcombe's, one-sided at 95 %; `{OURS}` is non-inferior where it is below {MARGIN:g} per 100. To
be so against every method needs every bound below, and no correction.
"""


def markdown(
    study: Study,
    whole: Mapping[str, Row],
    others: Sequence[Against],
    aside: Study | None,
    planned: Mapping[str, int],
) -> str:
    """Return the whole page.

    Parameters
    ----------
    study : the runs of conditions and seeds that all methods drove
    whole : the row of each method over all conditions
    others : comparisons of every other method with ours
    aside : study of variants of single methods
    planned : number of runs of each batch of the whole study, by its folder, without variants
    """
    rows_of = {condition: rows(study, condition) for condition in study.conditions}
    fewest = min((row.encounters for found in rows_of.values() for row in found), default=0)
    told = sentences(study, whole, fewest, others, sum(planned.values()))
    marks = differences(study, study.conditions, list(whole))
    parts = [
        _TITLE,
        "## The answer\n",
        "\n".join(f"{n}. {one}" for n, one in enumerate(told, 1)) + "\n",
        _PICTURE,
        basis(study, rows_of, planned),
        "## Every method over all conditions\n",
        table((*_HEADINGS,), map(_cells, whole.values())) + "\n",
        f"## Every method against `{OURS}`\n",
        table(_AGAINST, map(_against, others)) + "\n",
        "## Each condition\n",
        *(_block(study, condition, found, marks) for condition, found in rows_of.items()),
    ]
    if aside is not None:
        parts += ["## The rules as printed, beside ours\n"]
        parts += [_block(aside, one, rows(aside, one), {}) for one in aside.conditions]
    return "\n".join([*parts, _HOW])


def write_page(folder: Path, page: Path) -> None:
    """Write the results of the studies in a folder into a page, with its table and figure beside it.

    Raises
    ------
    StudyError
        If there are no runs in the folder, or if these or the table cannot be read.
    """
    path = page.with_suffix(".csv")
    write_table(path, merged(driven(folder), read_table(path) if path.exists() else []))
    runs = read_table(path)
    main = [one for one in runs if VARIANTS not in one.folder.parts]
    study = balanced(study_of_runs(main or runs))
    whole = {label: row for label in study.all_labels() if (row := pooled(study, label)).runs}
    others = against(study, whole)
    draw(page.parent / FIGURE, whole, others)
    aside = [one for one in runs if VARIANTS in one.folder.parts]
    beside = [one for one in main if MIDBLOCK in one.folder.parts and one.controller == "vo_paper"]
    variants = balanced(study_of_runs([*beside, *aside])) if aside else None
    write_text(page, markdown(study, whole, others, variants, _planned(folder / PLAN)))


def _planned(plan: Path) -> Mapping[str, int]:
    """Return the number of planned runs of each batch, without variants, which have a separate table."""
    runs = json.loads(plan.read_text("utf-8"))["runs"] if plan.exists() else {}
    return {batch: number for batch, number in runs.items() if VARIANTS not in Path(batch).parts}


def _against(one: Against) -> list[str]:
    return [
        one.method,
        _difference(one.delay),
        p_value(one.delay_p, ""),
        _difference(one.jerk),
        p_value(one.jerk_p, ""),
        _number(one.excess, "+.2f"),
        _number(one.bound, "+.2f"),
        "yes" if one.shown else "not shown",
    ]


def _difference(one: Comparison) -> str:
    if one.difference is None:
        return ""
    interval = "" if one.interval is None else f" ({one.interval.low:+.1f} … {one.interval.high:+.1f})"
    return f"{one.difference:+.1f}{interval}"


def _block(
    study: Study, condition: Condition, found: Sequence[Row], marks: Mapping[tuple[str, str], str]
) -> str:
    cells = [[*_cells(row), marks.get((condition.condition_id, row.method), "")] for row in found]
    return f"### {title(study, condition)}\n\n{table((*_HEADINGS, f'delay against {OURS} [s]'), cells)}\n"


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
