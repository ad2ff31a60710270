"""Writes the report of a search: a replay of the clearest failure of each kind, and a page on the search."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path

from analysis.search.results import FAIL, UNPREVENTABLE
from cosim.batches.conduct import Tally
from cosim.batches.worker import Handling
from cosim.errors import InputError
from cosim.presentation.page import write_page
from cosim.search.proposals import first_generations
from cosim.search.search import Found, Search, Shown
from cosim.search.space import Parameter
from cosim.search.trials import Trial, makers, running

NEEDED = ("matplotlib", "jinja2")
REPLAYS = "replays"
MOST = 12
"""Largest number of kinds that get a replay, the clearest ones first."""
_ROLES = {
    "fixed": "All runs have the seed {seeds}: traffic and everything else random is the same in each.",
    "averaged": "Each trial is run with the seeds {seeds}, and its mean margin is searched.",
    "searched": "The seed is one of {seeds} and searched like the other parameters.",
}


def require_packages() -> None:
    """Raise `InputError` if a package that the report needs is not installed."""
    for name in NEEDED:
        if find_spec(name) is None:
            raise InputError(
                f"{name} is not installed; run: pip install matplotlib Jinja2, or leave the report out with "
                "--no-report"
            )


def write_report(search: Search, found: Found, progress: Shown) -> Path:
    """Record the clearest failure of each kind, write its replay and the page of the search.

    Raises
    ------
    InputError
        If a required package is missing or the page cannot be written.
    """
    require_packages()
    from analysis.page.search import write_search_page
    from analysis.plots.saving import svg_text
    from analysis.plots.search import draw_boundary, draw_progress, most_deciding

    with progress as show:
        replayed = _replays(search, found, show)
    shown = most_deciding(found.axes, found.influences)
    return write_search_page(
        found.folder,
        title=found.folder.resolve().name,
        question=f"What breaks {search.request.controller} on {search.subject.loaded.name}?",
        answers=_answers(search, found),
        tried=found.tried,
        even=_even(search, found),
        kinds=found.kinds,
        replayed=replayed,
        influences=found.influences,
        space=[_row(one) for one in search.subject.space.parameters],
        seeds=_ROLES[search.subject.space.table.seed].format(seeds=", ".join(map(str, search.seeds))),
        boundary=svg_text(draw_boundary(shown, found.tried)) if len(shown) == 2 else "",
        progress=svg_text(draw_progress(found.tried)),
    )


def _replays(search: Search, found: Found, show: Callable[[Tally], None]) -> dict[int, str]:
    """Return the names of the recorded runs by the number of the kind."""
    if not found.kinds:
        return {}
    rows = found.kinds[:MOST]
    wanted = [
        Trial(
            Path(row.scenario).name, search.seedless(row.kind.worst.point), row.kind.worst.seed, row.kind.name
        )
        for row in rows
    ]
    folder = found.folder / REPLAYS
    handling = Handling(search.request.run_timeout_s)
    with (
        makers(search.subject, folder, search.request.where, handling) as hands,
        running(search.subject, folder, search.about, hands, len(wanted), show) as trials,
    ):
        answers = trials.run(wanted)
    write_page([folder])
    return {
        row.number: trials.run_folder(trial).name
        for row, trial, answer in zip(rows, wanted, answers, strict=True)
        if not answer.invalid
    }


def _answers(search: Search, found: Found) -> list[str]:
    counts = Counter(one.status for one in found.tried)
    told = [
        f"{len(found.tried)} runs by {search.request.method} found {counts[FAIL]} failures of "
        f"{len(found.kinds)} kinds that a careful driver would have prevented."
    ]
    if counts[UNPREVENTABLE]:
        told.append(
            f"{counts[UNPREVENTABLE]} runs failed where nobody could have prevented it; they do not count."
        )
    if found.stopped:
        told.append(f"It was stopped early: {found.stopped}.")
    if found.kinds:
        told.append(f"The clearest: {found.kinds[0].kind.name}.")
    return told


def _even(search: Search, found: Found) -> int:
    if search.request.method in ("sobol", "random"):
        return len(found.tried)
    return min(first_generations(search.request.method, search.request.budget), len(found.tried))


def _row(one: Parameter) -> dict[str, str]:
    axis = one.axis
    few: Sequence[str] = axis.choices[:6]
    choices = ", ".join(few) + (f" and {len(axis.choices) - len(few)} more" if axis.choices[6:] else "")
    return {
        "name": axis.name,
        "range": choices if axis.choices else f"{axis.low:g} to {axis.high:g}",
        "description": one.description,
        "source": one.source,
    }
