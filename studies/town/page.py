"""``python -m studies.town.page FOLDER PAGE``: write effort and results of a town's screening, with a map.

The text goes below the line ``## Results`` of the page, whose text above this line is kept, and the map
beside the page.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from analysis.errors import StudyError
from analysis.files import read_csv, read_json
from analysis.markdown import table, write_below
from analysis.recording.columns import TRAFFIC
from analysis.recording.reading import Area, read_map
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS
from analysis.screening.caution import caution
from analysis.screening.crossings_table import CROSSINGS, VALUES
from analysis.screening.ranking import BY_CONFLICTS, BY_RISK
from analysis.study.runs import find_run_folders
from studies.town.__main__ import SCREENING

RESULTS = "## Results"
SHOWN = 10
BESIDE_M = 100.0
"""Margin of the map around the crossings [m]."""

Cells = Mapping[str, str]


def write_page(folder: Path, page: Path) -> None:
    """Write the effort and the results of a town's screening.

    Raises
    ------
    StudyError
        If the crossings are not ranked yet.
    """
    out = folder / SCREENING
    runs = find_run_folders(out)
    if not runs or not (out / CROSSINGS.file).is_file():
        raise StudyError(f"{folder}: no ranking; python -m studies.town {folder} makes it")
    crossings = read_csv(out / CROSSINGS.file)
    draw(read_map(runs[0]), crossings, page.with_suffix(".svg"))
    parts = [
        _effort(out, runs, crossings),
        f"![Map of the crossings]({page.with_suffix('.svg').name})",
        _worst(crossings),
    ]
    write_below(page, RESULTS, "\n\n".join(parts) + "\n", "# A whole town")


def _effort(out: Path, runs: Sequence[Path], crossings: Sequence[Cells]) -> str:
    struck = caution([_numbers(row) for row in crossings])
    told: list[dict[str, Any]] = [read_json(run / "run.json") for run in runs]
    ranked = [row for row in crossings if row["rank"]]
    recorded = sum((run / TRAFFIC.file).stat().st_size for run in runs if (run / TRAFFIC.file).is_file())
    counted = sum(float(one["duration_s"]) for one in told)
    rows = (
        ("runs", f"{len(runs)}"),
        ("simulated time that counts", f"{counted / 60.0:.0f} min in all"),
        ("wall time of the runs, one after the other", f"{sum(one['wall_total_s'] for one in told):.0f} s"),
        ("of it simulating", f"{sum(one['wall_s'] for one in told):.0f} s"),
        ("recording of everybody", f"{recorded / 1e6 * 3600.0 / counted:.0f} MB per simulated hour"),
        ("crossings", f"{len(crossings)}"),
        ("ranked", f"{len(ranked)}"),
        ("significantly worse than the others", f"{sum(row['worse'] == '1' for row in ranked)}"),
        ("rows of traffic_encounters.csv", f"{len(read_csv(out / TRAFFIC_ENCOUNTERS.file))}"),
        ("conflicts", f"{sum(int(row['n_conflicts']) for row in crossings)}"),
        ("of them collisions", f"{sum(int(row['n_collisions']) for row in crossings)}"),
    )
    return f"{table(('what', 'how much'), rows)}\n\n{struck + '.' if struck else ''}".rstrip()


def _numbers(row: Cells) -> dict[str, float]:
    names = ("n_collisions", "entered_per_h", "observed_h")
    return {name: float(row[name] or 0.0) for name in names}


def _worst(crossings: Sequence[Cells]) -> str:
    heads = (
        *("rank", "95 %", "rank by conflicts", "crossing", "conflicts", "expected per 1000 pedestrians"),
        *("fatal if struck", "risk per 1000 pedestrians", "what is unusual"),
    )
    return table(
        heads,
        [
            [
                f"{float(row['rank']):g}",
                f"{float(row['rank_lo']):.0f}–{float(row['rank_hi']):.0f}" if row["rank_lo"] else "",
                f"{float(row['rank_by_conflicts']):g}",
                f"`{row['crossing_id']}`" + (" (worse)" if row["worse"] == "1" else ""),
                row["n_conflicts"],
                f"{float(row[VALUES[BY_CONFLICTS]]):.0f}",
                f"{float(row['p_fatal_expected']):.1%}",
                f"{float(row[VALUES[BY_RISK]]):.3g}",
                row["reasons"],
            ]
            for row in [row for row in crossings if row["rank"]][:SHOWN]
        ],
    )


def draw(areas: Sequence[Area], crossings: Sequence[Cells], path: Path) -> None:
    """Draw the crossings on the roads near them, coloured by risk; hollow circles are not ranked."""
    figure = Figure(figsize=(8.0, 8.0), dpi=120, layout="constrained")
    axes = figure.subplots()
    for area in areas:
        if area.kind == "lane":
            axes.plot(*area.shape.T, color="#bbbbbb", linewidth=0.6, zorder=1, rasterized=True)
    ranked = [row for row in crossings if row["rank"]]
    others = [row for row in crossings if not row["rank"]]
    x, y = _places(others)
    axes.scatter(x, y, s=8, facecolors="none", edgecolors="#777777", linewidths=0.5, zorder=2)
    risks = [float(row[VALUES[BY_RISK]]) for row in ranked]
    if ranked:
        x, y = _places(ranked)
        shown = axes.scatter(x, y, s=28, c=risks, cmap="YlOrRd", edgecolors="#333333", zorder=3)
        figure.colorbar(shown, ax=axes, shrink=0.6, label="risk per 1000 pedestrians")
    x, y = _places(crossings)  # railways lead far out of the town
    axes.set_xlim(min(x) - BESIDE_M, max(x) + BESIDE_M)
    axes.set_ylim(min(y) - BESIDE_M, max(y) + BESIDE_M)
    axes.set_aspect("equal")
    axes.set_xlabel("x_m")
    axes.set_ylabel("y_m")
    with matplotlib.rc_context({"svg.hashsalt": "cosim"}):
        figure.savefig(path, metadata={"Date": None})


def _places(rows: Sequence[Cells]) -> tuple[list[float], list[float]]:
    return [float(row["x_m"]) for row in rows], [float(row["y_m"]) for row in rows]


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except StudyError as problem:
        sys.exit(f"town: {problem}")
