"""``python -m studies.planted.page FOLDER PAGE``: write the table of the finished replications.

The table goes below the line ``## Table`` of the page; the text above this line is kept.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from analysis.errors import StudyError
from analysis.markdown import table, write_below
from analysis.screening.ranking import BY_CONFLICTS, BY_RISK
from analysis.statistics.intervals import share_interval
from studies.planted.outcomes import CHOSEN_ON, RUNS, Replication, replications
from studies.planted.town import DEFECTS, STREETS, Defect

TABLE = "## Table"
BARS = {"found": 0.90, "false_alarms": 0.05}
"""Smallest share of replications that find the planted crossing, and largest share of false alarms."""
WHOLE = 50 - CHOSEN_ON
"""Number of replications of the complete study that count."""
MEASURES = {
    BY_RISK: "Ranked by risk (as `cosim screen` does)",
    BY_CONFLICTS: "Ranked by conflicts alone (`--rank-by conflicts`)",
}
_HEADS = (
    *("planted", "replications", "conflicts per 1000 pedestrians there", "on the others"),
    *("ranks first (95 %)", "median rank", "called worse", "others called worse (95 %)"),
    "fewest pedestrians on a crossing",
)


def markdown(found: Mapping[str, Mapping[str, list[Replication]]]) -> str:
    """Return for each measure a table with a row for each variant, and the verdict on the required shares.

    Parameters
    ----------
    found
        The replications of each variant, by measure of ranking.
    """
    parts = [_part({name: made[by] for name, made in found.items()}, by) for by in MEASURES]
    return "\n".join(parts)


def _part(found: Mapping[str, list[Replication]], by: str) -> str:
    rows = [_texts(defect, found[defect.name]) for defect in DEFECTS if found[defect.name]]
    return f"### {MEASURES[by]}\n\n{table(_HEADS, rows)}\n\n{_verdict(found)}\n"


def write_page(folder: Path, page: Path) -> None:
    """Write the table of a study's folder.

    Raises
    ------
    StudyError
        If no replication is finished, or its files cannot be read.
    """
    found = {defect.name: replications(folder, defect) for defect in DEFECTS}
    if not any(made[BY_RISK] for made in found.values()):
        raise StudyError(f"{folder}: no finished replication; python -m studies.planted {folder} makes them")
    write_below(page, TABLE, markdown(found), "# Planted defects")


def _texts(defect: Defect, made: Sequence[Replication]) -> list[str]:
    rates = 1000.0 * np.mean([one.rates for one in made], axis=0)
    planted = defect.name != "nothing"
    alarms, others = _alarms(defect, made)
    return [
        defect.meaning,
        str(len(made)),
        f"{rates[0]:.0f}",
        f"{rates[1]:.0f}",
        _share(sum(one.found for one in made), len(made)) if planted else "",
        f"{np.median([one.rank for one in made]):g}",
        _share(sum(one.called_worse for one in made), len(made)) if planted else "",
        _share(alarms, others),
        f"{min(one.pedestrians for one in made):.0f}",
    ]


def _alarms(defect: Defect, made: Sequence[Replication]) -> tuple[int, int]:
    """Return how many crossings without a defect were called worse, and how many there were."""
    if defect.name == "nothing":
        return sum(int(one.worse.sum()) for one in made), STREETS * len(made)
    return sum(one.false_alarms for one in made), (STREETS - 1) * len(made)


def _share(hits: int, of: int) -> str:
    ends = share_interval(hits, of)
    interval = "" if ends is None else f" ({ends.low:.0%} … {ends.high:.0%})"
    return f"{hits} of {of}, {hits / of:.0%}{interval}"


def _verdict(found: Mapping[str, list[Replication]]) -> str:
    """Return which required shares are met, one line each."""
    lines = []
    for defect in DEFECTS:
        made = found[defect.name]
        if not made:
            lines.append(f"- {defect.name}: not run.")
        elif defect.name == "nothing":
            bar = BARS["false_alarms"]
            word = _decided(*_alarms(defect, made), len(made), at_most=bar)
            lines.append(f"- {defect.name}: at most {bar:.0%} of crossings called worse: {word}.")
        else:
            bar = BARS["found"]
            word = _decided(sum(one.found for one in made), len(made), len(made), at_least=bar)
            lines.append(f"- {defect.name}: first in at least {bar:.0%} of replications: {word}.")
    return f"A replication is {RUNS} runs. The bars, on the replications above:\n\n" + "\n".join(lines)


def _decided(hits: int, of: int, made: int, at_least: float = 0.0, at_most: float = 1.0) -> str:
    """Return whether a share meets its requirement; in a partial study, only its whole interval decides."""
    ends = share_interval(hits, of)
    share = hits / of
    low, high = (share, share) if made >= WHOLE or ends is None else (ends.low, ends.high)
    if low >= at_least and high <= at_most:
        return "met"
    if high < at_least or low > at_most:
        return "**missed**"
    return f"not decided by {made} of {WHOLE} replications"


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except StudyError as problem:
        sys.exit(f"planted: {problem}")
