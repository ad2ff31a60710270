"""``python -m studies.protocols.page FOLDER PAGE``: write the verdicts of all suites below ``## Tables``.

FOLDER holds, at any depth, one ``protocol.csv`` for each suite and set of controllers.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from analysis.errors import AnalysisError
from analysis.markdown import table, write_below
from studies.protocols.table import FILE, read, score
from sumo_scenarios.suites.tables import GroupTable, read_suite
from sumo_scenarios.suites.tables import names as suite_names

TABLES = "## Tables"
SHARES = ("standard", "extended", "robustness")
Cells = dict[str, str]


def write_page(folder: Path, page: Path) -> None:
    """Write the tables of all verdicts in a folder.

    Raises
    ------
    AnalysisError
        If there are no verdicts, or they cannot be read.
    """
    files = sorted(folder.rglob(FILE))
    if not files:
        raise AnalysisError(f"{folder}: no {FILE}; python -m studies.protocols NAME --out {folder} makes one")
    rows = [row for file in files for row in read(file)]
    write_below(page, TABLES, markdown(rows), "# Test protocols")


def markdown(rows: Sequence[Cells]) -> str:
    """Return all tables as Markdown."""
    controllers = sorted({row["controller"] for row in rows})
    suites = [name for name in suite_names() if any(row["suite"] == name for row in rows)]
    blocks = ["### All suites\n", _summary(rows, suites, controllers)]
    for suite in suites:
        own = [row for row in rows if row["suite"] == suite]
        drove = [name for name in controllers if any(row["controller"] == name for row in own)]
        found = read_suite(suite)
        blocks += [f"### {suite}\n", f"{found.title}; {found.label}.\n", _groups(own, found.groups, drove)]
        if found.points:
            blocks.append(_scores(own, found.points, drove))
    return "\n".join(blocks)


def _summary(rows: Sequence[Cells], suites: Sequence[str], controllers: Sequence[str]) -> str:
    """Return the passed cases, preventable failures and hardest braking of each controller."""
    lines = [["controller", *suites, "preventable cases failed", "hardest braking [m/s²]"]]
    for name in controllers:
        own = [row for row in rows if row["controller"] == name]
        hardest = max((float(row["max_deceleration_mps2"] or 0.0) for row in own), default=0.0)
        texts = []
        for suite in suites:
            some = [row for row in own if row["suite"] == suite]
            texts.append(f"{_passed(some)} of {len(some)}" if some else "–")
        lines.append([f"`{name}`", *texts, str(sum(row["counts"] == "1" for row in own)), f"{hardest:.1f}"])
    return _table(lines)


def _groups(rows: Sequence[Cells], groups: Sequence[GroupTable], controllers: Sequence[str]) -> str:
    lines = [["group", "ego [km/h]", *(f"`{name}`" for name in controllers)]]
    for group in groups:
        speeds = ", ".join(f"{speed:g}" for speed in group.speeds_kmh)
        texts = [
            _cell([row for row in rows if row["group"] == group.name and row["controller"] == name])
            for name in controllers
        ]
        if any(texts):
            lines.append([f"`{group.name}`: {group.description}", speeds, *texts])
    return _table(lines)


def _cell(rows: Sequence[Cells]) -> str:
    """Return how many cases were passed, and for each with a contact or a fault, its speed and the reason."""
    if not rows:
        return ""
    told = [text for row in rows if (text := _told(row))]
    return f"{_passed(rows)} of {len(rows)}" + (f" ({', '.join(told)})" if told else "")


def _told(row: Cells) -> str:
    speed = f"{float(row['ego_speed_kmh']):g}"
    if row["valid"] != "1":
        return f"{speed}: invalid"
    mark = "" if row["passed"] == "1" or row["counts"] == "1" else "°"
    if row["impact_speed_kmh"]:
        colour = f" {row['colour']}" if row["colour"] else ""
        return f"{speed}{mark}: {float(row['impact_speed_kmh']):.0f}{colour}"
    return "" if row["passed"] == "1" else f"{speed}{mark}: {row['note']}"


def _scores(rows: Sequence[Cells], points: dict[str, dict[str, float]], controllers: Sequence[str]) -> str:
    """Return the points of each part of a rating, and their sum."""
    lines = [["points", "at most", *(f"`{name}`" for name in controllers)]]
    totals = dict.fromkeys(controllers, 0.0)
    most_of_all = 0.0
    for part, shares in points.items():
        for share in (name for name in SHARES if name in shares):
            most = shares[share]
            most_of_all += most
            texts = []
            for name in controllers:
                own = [
                    float(row["points"] or 0.0)
                    for row in rows
                    if row["controller"] == name
                    and row["group"].startswith(f"{part}_")
                    and row["share"] == share
                ]
                # If a part was not driven, there is no sum.
                gained = score(own, most) if own else math.nan
                totals[name] += gained
                texts.append(_points(gained, 3))
            lines.append([f"{part}, {share}", f"{most:g}", *texts])
    lines.append(["all", f"{most_of_all:g}", *(f"**{_points(totals[name], 2)}**" for name in controllers)])
    return _table(lines)


def _points(value: float, digits: int) -> str:
    return "–" if math.isnan(value) else f"{value:.{digits}f}"


def _passed(rows: Iterable[Cells]) -> int:
    return sum(row["passed"] == "1" for row in rows)


def _table(lines: Sequence[Sequence[str]]) -> str:
    heads, *rows = lines
    return table(heads, rows) + "\n"


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except AnalysisError as problem:
        sys.exit(f"cosim: {problem}")
