"""The crossings of a screened network: a map of the network, their table and their worst encounters."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from analysis.arrays import FloatArray
from analysis.encounters.severity_scale import CONFLICTS
from analysis.errors import RecordingError
from analysis.page.encounters import Encounters
from analysis.page.tables import read_rows
from analysis.recording.reading import Area, read_map
from analysis.screening.caution import caution
from analysis.screening.changes import CHANGES, TOTAL
from analysis.screening.crossings_table import CROSSINGS, VALUES, value_column
from analysis.screening.ranking import BY_CONFLICTS, BY_RISK
from analysis.study.runs import StudyRun
from analysis.wording import some

COLOURS = 5
OF_EACH = 3
"""This many of a crossing's worst encounters are listed."""
SMALLEST, LARGEST = 0.006, 0.018
"""Smallest and largest radius of crossings on the map, as shares of its longer side."""
LOWEST = 0.15
"""Least height of the map, as a share of its longer side."""
MARGIN = 0.03
"""Margin around the map, as a share of its longer side."""
LENGTHS = (10, 20, 50, 100, 200, 500, 1000, 2000, 5000)
"""Possible lengths of the scale bar [m]."""

Row = Mapping[str, Any]


def screening(root: Path | None, runs: Sequence[StudyRun]) -> dict[str, Any] | None:
    """Return what the page says about the crossings; ``None`` if none were ranked.

    Raises
    ------
    StudyError
        If a table of the screening cannot be read.
    """
    if root is None or not (root / CROSSINGS.file).is_file():
        return None
    rows = read_rows(root / CROSSINGS.file, CROSSINGS)
    ranked = [row for row in rows if row["rank"] is not None]
    return {
        "rows": rows,
        "ranked": ranked,
        "seeds": len({run.seed for run in runs if run.valid}),
        "by_risk": value_column(rows) == VALUES[BY_RISK],
        "map": _map(rows, _areas(runs), value_column(rows)),
        "caution": caution(rows),
        "changes": _changes(root / CHANGES.file),
    }


def answers(found: Mapping[str, Any]) -> list[str]:
    """Return the answers at the top of the page, one sentence each."""
    rows, ranked = found["rows"], found["ranked"]
    worse = [row["crossing_id"] for row in ranked if row["worse"]]
    told = [f"{len(ranked)} of {len(rows)} crossings had enough pedestrians to be ranked."]
    if ranked:
        first = ranked[0]
        interval = ""
        if first["rank_lo"] is not None:
            interval = f" (rank 1, 95 % {first['rank_lo']:.0f} to {first['rank_hi']:.0f})"
        why = f"; {first['reasons']}" if first["reasons"] else ""
        conflicts = f"{first[VALUES[BY_CONFLICTS]]:.1f} conflicts expected per 1000 pedestrians"
        if found["by_risk"]:
            told.append(
                f"The risk is highest at {first['crossing_id']}{interval}: {conflicts}, "
                f"{first['p_fatal_expected']:.1%} of them fatal if the vehicle did not slow down{why}."
            )
        else:
            told.append(
                f"Most conflicts are to be expected at {first['crossing_id']}{interval}: {conflicts}{why}."
            )
        told.append(f"Significantly worse than the others: {some(worse, 5) or 'none'}.")
    return told


def _areas(runs: Iterable[StudyRun]) -> list[Area]:
    """Return the lanes on the maps of all valid runs, each once."""
    known: dict[str, Area] = {}
    for run in runs:
        try:
            listed = read_map(run.folder) if run.valid else ()
        except RecordingError:
            continue  # its recording was not kept
        known |= {area.name: area for area in listed if area.kind == "lane" and area.name not in known}
    return list(known.values())


def _map(rows: Sequence[Row], lanes: Sequence[Area], value: str) -> dict[str, Any]:
    """Return lines and circles in a plane with y downwards; colour and size of a crossing show its value."""
    places = np.array([[row["x_m"], row["y_m"]] for row in rows])
    points = np.concatenate([places, *(lane.shape for lane in lanes)])
    low, high = points.min(axis=0), points.max(axis=0)
    side = float((high - low).max())
    # The map of a single street would be so narrow that the scale bar would hide the road.
    room = np.maximum(0.5 * (LOWEST * side - (high - low)), 0.0) * (0.0, 1.0) + MARGIN * side
    low, high = low - room, high + room
    most = max((row[value] for row in rows if row["rank"] is not None), default=0.0) or 1.0
    size = high - low
    return {
        "width": size[0],
        "height": size[1],
        "roads": [
            {"width": width, "path": " ".join(_path(lane.shape, low, high) for lane in some)}
            for width, some in groupby(sorted(lanes, key=lambda one: one.width_m), lambda one: one.width_m)
        ],
        "crossings": [
            {
                "row": row,
                "x": row["x_m"] - low[0],
                "y": high[1] - row["y_m"],
                "radius": side * (SMALLEST + (LARGEST - SMALLEST) * _share(row, value, most)),
                "colour": 0
                if row["rank"] is None
                else 1 + min(COLOURS - 1, int(COLOURS * _share(row, value, most))),
            }
            # The worst crossings are drawn last, on top of the others.
            for row in reversed(rows)
        ],
        "bar": max((length for length in LENGTHS if length <= 0.2 * size[0]), default=LENGTHS[0]),
        "line": 0.002 * side,
        "steps": [f"{most * number / COLOURS:.3g}" for number in range(COLOURS + 1)],
    }


def _share(row: Row, value: str, most: float) -> float:
    return 0.0 if row["rank"] is None else float(row[value] / most)


def _path(shape: FloatArray, low: FloatArray, high: FloatArray) -> str:
    x, y = shape[:, 0] - low[0], high[1] - shape[:, 1]
    return "M" + "L".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))


def worst_of_each(found: Encounters, order: Sequence[int]) -> dict[str, list[int]]:
    """Return the rows of each crossing's worst conflicts.

    Parameters
    ----------
    found : all encounters
    order : their rows, the worst first
    """
    rows: defaultdict[str, list[int]] = defaultdict(list)
    for row in order:
        crossing = found.texts["crossing_id"][row]
        if crossing and found.texts["severity"][row] in CONFLICTS and len(rows[crossing]) < OF_EACH:
            rows[crossing].append(row)
    return rows


def _changes(path: Path) -> dict[str, list[dict[str, Any]]] | None:
    if not path.is_file():
        return None
    rows = read_rows(path, CHANGES)
    return {
        "total": [row for row in rows if row["crossing_id"] == TOTAL],
        "changed": [row for row in rows if row["changed"] and row["crossing_id"] != TOTAL],
    }
