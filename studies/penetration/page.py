"""``python -m studies.penetration.page STUDY PAGE``: write tables and figures over the share of egos.

The tables of each scenario go below the line ``## Tables`` of the page, whose text above this line is kept,
and the figures beside the page.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from analysis.errors import StudyError
from analysis.markdown import table, write_below
from analysis.statistics.intervals import Interval, mean_interval
from analysis.statistics.paired import compare_values
from analysis.study.runs import read_runs
from studies.finished import run_folders
from studies.penetration.figure import draw
from studies.penetration.outcomes import ALL, MEASURES, WHO, Measure, Outcome, outcomes

TABLES = "## Tables"


def markdown(found: Sequence[Outcome]) -> str:
    """Return a table for each measure in one scenario, with a row per share and 95 % intervals over seeds."""
    return "\n".join(_table(measure, found) for measure in MEASURES)


def write_page(folder: Path, page: Path) -> None:
    """Write tables and figures of a study's folder.

    Raises
    ------
    StudyError
        If there are no runs in the folder, or they cannot be read.
    """
    found = outcomes(read_runs(run_folders(folder)))
    sections = []
    for scenario in sorted({one.scenario for one in found}):
        here = [one for one in found if one.scenario == scenario]
        figure = page.with_name(f"{page.stem}-{scenario}.svg")
        draw(here, figure)
        shown = f"![Safety and delay over the share of egos, {scenario}]({figure.name})"
        sections.append(f"### `{scenario}`\n\n{shown}\n\n{markdown(here)}")
    write_below(page, TABLES, "\n".join(sections), "# Penetration")


def of(found: Sequence[Outcome], share: float, measure: str, who: str) -> dict[int, float]:
    """Return the defined values of a measure at a share, by seed."""
    values = {one.seed: one.values.get((measure, who), np.nan) for one in found if one.share == share}
    return {seed: value for seed, value in values.items() if np.isfinite(value)}


def _table(measure: Measure, found: Sequence[Outcome]) -> str:
    who = WHO if measure.split else (ALL,)
    heads = ("share of egos", "runs", *(f"{one} (95 %)" for one in who), "all, against no egos (95 %)")
    shares = sorted({one.share for one in found})
    base = of(found, shares[0], measure.name, ALL)
    rows = []
    for share in shares:
        cells = [_mean(of(found, share, measure.name, one)) for one in who]
        here = of(found, share, measure.name, ALL)
        against = "" if share == shares[0] else _difference(base, here)
        runs = len({one.seed for one in found if one.share == share})
        rows.append([f"{share:g}", str(runs), *cells, against])
    title = measure.title[0].upper() + measure.title[1:]
    return f"#### {title} [{measure.unit}]\n\n{table(heads, rows)}\n"


def _mean(values: dict[int, float]) -> str:
    if not values:
        return ""
    some = np.array(list(values.values()))
    return f"{some.mean():.3g}{_interval(mean_interval(some))}"


def _difference(base: dict[int, float], here: dict[int, float]) -> str:
    seeds = sorted(base.keys() & here.keys())
    compared = compare_values(*(np.array([side[seed] for seed in seeds]) for side in (base, here)))
    if compared.difference is None:
        return ""
    return f"{compared.difference:+.3g}{_interval(compared.interval)}"


def _interval(ends: Interval | None) -> str:
    return "" if ends is None else f" ({ends.low:.3g} … {ends.high:.3g})"


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except StudyError as problem:
        sys.exit(f"penetration: {problem}")
