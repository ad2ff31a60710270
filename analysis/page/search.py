"""Writes the page of a search: kinds of failures, boundary, sensitivity, progress."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from analysis.files import write_text
from analysis.page.report import PAGE, environment
from analysis.plots.search import draw_boundary, draw_progress
from analysis.search.axes import Axis
from analysis.search.results import FAIL, UNPREVENTABLE, KindRow, Tried
from analysis.search.sensitivity import Influence


def write_search_page(
    out: Path,
    *,
    title: str,
    question: str,
    answers: Sequence[str],
    axes: Sequence[Axis],
    tried: Sequence[Tried],
    even: int,
    kinds: Sequence[KindRow],
    replayed: Mapping[int, str],
    influences: Sequence[Influence],
    space: Sequence[Mapping[str, str]],
    seeds: str,
) -> Path:
    """Write ``report.html`` of a search and return its path.

    Parameters
    ----------
    out
        Folder of the search.
    title, question, answers
        Top of the page.
    axes, tried, kinds, influences
        What was found.
    even
        Number of runs that the influences are from.
    replayed
        Runs that are in ``replays/report.html``, by the number of the kind.
    space
        Rows of what was varied: name, range, description, source.
    seeds
        What the seed did, a sentence.
    """
    shown = _most_deciding(axes, influences)
    page = environment().get_template("search.html.jinja")
    content = page.render(
        title=title,
        question=question,
        answers=list(answers),
        facts=_facts(tried, kinds),
        kinds=[_kind(row, replayed) for row in kinds],
        boundary=_svg(draw_boundary(shown, tried)) if len(shown) == 2 else "",
        progress=_svg(draw_progress(tried)),
        influences=list(influences),
        even=even,
        space=list(space),
        seeds=seeds,
    )
    return write_text(out / PAGE, content)


def _most_deciding(axes: Sequence[Axis], influences: Sequence[Influence]) -> list[Axis]:
    """Return the two axes that decide most; without any influences the first two numbers."""
    by_name = {axis.name: axis for axis in axes}
    order = [by_name[one.axis] for one in influences] or sorted(axes, key=lambda axis: not axis.numeric)
    return order[:2]


def _facts(tried: Sequence[Tried], kinds: Sequence[KindRow]) -> list[dict[str, str]]:
    statuses = [one.status for one in tried]
    first = statuses.index(FAIL) + 1 if FAIL in statuses else None
    return [
        {"name": "runs", "value": str(len(tried))},
        {"name": "preventable failures", "value": str(statuses.count(FAIL))},
        {"name": "kinds", "value": str(len(kinds))},
        {"name": "runs to the first", "value": "–" if first is None else str(first)},
        {"name": "unpreventable ones", "value": str(statuses.count(UNPREVENTABLE))},
    ]


def _kind(row: KindRow, replayed: Mapping[int, str]) -> dict[str, Any]:
    return {
        "number": row.number,
        "name": row.kind.name,
        "count": len(row.kind.failures),
        "margin": row.kind.worst.margin,
        "change": row.change,
        "command": row.command,
        "replayed": row.number in replayed,
        "run": replayed.get(row.number, ""),
    }


def _svg(figure: Figure) -> str:
    """Return a figure as an element of a page, the same bytes each time."""
    text = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": "cosim", "svg.fonttype": "none"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    return re.sub(r"^.*?(?=<svg)", "", text.getvalue(), flags=re.DOTALL)
