"""The few numbers at the top of the page: a row of tiles for each controller."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from analysis.page.encounters import OF_EGOS, SEVERITIES, Encounters, Listing
from analysis.study.design import Study
from analysis.study.runs import StudyRun

TRAFFIC = "all traffic"


def rows_of_tiles(study: Study, found: Encounters, listing: Listing) -> list[dict[str, Any]]:
    """Return one row for each configuration, or one for all traffic if no ego was driven.

    The counts of different controllers are never added up.
    """
    if listing is not OF_EGOS:
        every = np.ones(len(found), dtype=np.bool_)
        return [{"name": TRAFFIC, "tiles": _tiles(study.runs, found.runs, found, every, listing)}]
    rows = []
    for label in study.all_labels():
        mine = [run for run in study.runs if study.label(run) == label]
        valid = {number: run for number, run in enumerate(found.runs) if study.label(run) == label}
        chosen = np.isin(found.owner, list(valid))
        rows.append({"name": label, "tiles": _tiles(mine, list(valid.values()), found, chosen, listing)})
    return rows


def _tiles(
    runs: Sequence[StudyRun],
    valid: Sequence[StudyRun],
    found: Encounters,
    chosen: np.ndarray[Any, np.dtype[np.bool_]],
    listing: Listing,
) -> list[Mapping[str, str]]:
    severity = np.array(found.texts.get("severity", ()), dtype=np.str_)[chosen]
    numbers = {name: values[chosen] for name, values in found.numbers.items()}
    hit = severity == "collision"
    entered = int(np.count_nonzero((numbers["entered"] == 1.0) | hit))
    # A collision is preventable if a careful driver would prevent it; an undefined one counts as preventable.
    preventable = int(np.count_nonzero(hit & (numbers["preventable_r157"] != 0.0)))
    bad = int(np.isin(severity, SEVERITIES[: SEVERITIES.index("serious") + 1]).sum())
    # A pedestrian who touched the standing ego had no collision, although the distance was 0.
    standing = round(sum(run.numbers.get("n_contacts_standing", 0.0) for run in valid))
    tiles = [
        ("valid runs", f"{len(valid)} of {len(runs)}"),
        ("encounters", f"{len(severity):,}"),
        ("of them entered", f"{entered:,}"),
        ("collisions", str(int(hit.sum()))),
        ("of them preventable", str(preventable)),
        *([("standing contacts", str(standing))] if listing is OF_EGOS else []),
        ("serious or worse", str(bad)),
        ("smallest TTC", _smallest(numbers["min_ttc_s"], "s")),
        ("smallest distance", _smallest(numbers["min_dist_m"], "m")),
    ]
    more = {"serious or worse": f"{bad / entered:.1%} of entered".replace("%", " %")} if entered else {}
    return [{"name": name, "value": value, "more": more.get(name, "")} for name, value in tiles]


def _smallest(values: np.ndarray[Any, np.dtype[np.float64]], unit: str) -> str:
    known = values[np.isfinite(values)]
    return f"{known.min():.2f} {unit}" if len(known) else "–"
