"""Writes the page of a search: kinds of failures, boundary, sensitivity, progress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from analysis.files import write_text
from analysis.page.names import PAGE
from analysis.page.report import environment
from analysis.search.results import FAIL, UNPREVENTABLE, KindRow, Tried
from analysis.search.sensitivity import Influence


def write_search_page(
    out: Path,
    *,
    title: str,
    question: str,
    answers: Sequence[str],
    tried: Sequence[Tried],
    even: int,
    kinds: Sequence[KindRow],
    replayed: Mapping[int, str],
    influences: Sequence[Influence],
    space: Sequence[Mapping[str, str]],
    seeds: str,
    boundary: str,
    progress: str,
) -> Path:
    """Write ``report.html`` of a search and return its path.

    Parameters
    ----------
    out
        Folder of the search.
    title, question, answers
        Texts at the top of the page.
    tried, kinds, influences
        Runs tried, kinds of failures and influences found.
    even
        Number of runs from which the influences were computed.
    replayed
        Runs with a replay in ``replays/report.html``, by the number of the kind.
    space
        Rows of the quantities varied: name, range, description, source.
    seeds
        A sentence that says what the seed did.
    boundary, progress
        Figures as SVG; empty if there is none.
    """
    page = environment().get_template("search.html.jinja")
    content = page.render(
        title=title,
        question=question,
        answers=list(answers),
        facts=_facts(tried, kinds),
        kinds=[_kind(row, replayed) for row in kinds],
        boundary=boundary,
        progress=progress,
        influences=list(influences),
        even=even,
        space=list(space),
        seeds=seeds,
    )
    return write_text(out / PAGE, content)


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
