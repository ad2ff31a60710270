"""``make study-roadside``: what a roadside unit buys where a bus hides pedestrians.

``python -m cosim.study_roadside STUDY PAGE`` reads the runs of ``studies/roadside.toml`` and writes their
tables below the line ``## Tables`` of a page, which keeps what stands above it, and a figure beside it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from analysis import schema
from analysis.errors import StudyError
from analysis.statistics.intervals import FloatArray, share_interval
from analysis.statistics.paired import compare_values
from analysis.study_runs import StudyRun, find_run_folders, read_runs

TABLES = "## Tables"
BASE = ("onboard", None)
"""What every other sensing is compared with: a car that has only its own sensor."""
_HEADS = (
    "sensing",
    "latency [ms]",
    "valid runs",
    "encounters",
    "contacts",
    "share (95 %)",
    "contacts, preventable",
    "told before the conflict [s]",
    "delay of a trip [s]",
    "contacts per encounter, against onboard",
    "delay, against onboard [s]",
)
_ORDER = ("perfect", "onboard", "roadside", "fused")

Seeing = tuple[str, float | None]
"""Sensing model, and the latency of its messages where it has some [ms]."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """One run's numbers."""

    seed: int
    encounters: int
    """With people who were in the ego's path, or were touched."""
    contacts: int
    preventable: int
    """Contacts that the reference driver would have prevented from when the ego was told."""
    told: FloatArray
    """How long the ego had been told of each of them when the conflict came [s]."""
    delay: float


@dataclass(frozen=True, slots=True)
class Cell:
    """One driver with one sensing, where one thing hides people."""

    hidden_by: str
    driver: str
    seeing: Seeing
    runs: int
    outcomes: tuple[Outcome, ...]
    """Of the valid runs, by seed."""

    @property
    def encounters(self) -> int:
        """Return their number in all runs."""
        return sum(one.encounters for one in self.outcomes)

    @property
    def contacts(self) -> int:
        """Return their number in all runs."""
        return sum(one.contacts for one in self.outcomes)

    @property
    def delay(self) -> float | None:
        """Return the mean of the runs [s]."""
        return float(np.mean([one.delay for one in self.outcomes])) if self.outcomes else None


def cells(runs: Iterable[StudyRun]) -> list[Cell]:
    """Return the cells of a study, in a fixed order."""
    runs = list(runs)
    several = {run.parameters.get("hidden_speed_mps") for run in runs} - {None}
    groups: dict[tuple[str, str, Seeing], list[StudyRun]] = {}
    for run in runs:
        driver = run.controller
        pace = run.parameters.get("hidden_speed_mps")
        if pace is not None and len(several) > 1:
            driver += f", hidden_speed_mps = {float(pace):g}"
        groups.setdefault((run.setting["hidden_by"], driver, seeing_of(run)), []).append(run)
    found = []
    for key, mine in groups.items():
        valid = sorted((run for run in mine if run.valid), key=lambda run: run.seed)
        found.append(Cell(*key, len(mine), tuple(outcome_of(run) for run in valid)))
    return sorted(
        found,
        key=lambda cell: (
            cell.hidden_by,
            cell.driver,
            _ORDER.index(cell.seeing[0]),
            cell.seeing[1] if cell.seeing[1] is not None else -1.0,
        ),
    )


def seeing_of(run: StudyRun) -> Seeing:
    """Return how the ego of a run comes to know of people."""
    latency = run.setting.get("sensing.latency_ms")
    return run.setting["sensing"], None if latency is None else float(latency)


def outcome_of(run: StudyRun) -> Outcome:
    """Return the numbers of a valid run."""
    table = pd.read_csv(run.folder / schema.ENCOUNTERS.file)
    met = table[(table["entered"] == 1) | (table["collision"] == 1)]
    touched = met[met["collision"] == 1]
    return Outcome(
        run.seed,
        len(met),
        len(touched),
        int((touched["preventable_r157"] == 1).sum()),
        met["visible_before_conflict_s"].dropna().to_numpy(dtype=np.float64),
        run.numbers["ego_delay_mean_s"],
    )


def against(cell: Cell, base: Cell | None, what: str) -> str:
    """Return the mean difference of two cells over the seeds that both have, with its 95 % interval.

    Parameters
    ----------
    cell, base : two sensings of one driver
    what : ``contacts`` per encounter, or ``delay`` [s]
    """
    if base is None or base is cell:
        return ""
    values = [{one.seed: _value(one, what) for one in side.outcomes} for side in (base, cell)]
    seeds = sorted(values[0].keys() & values[1].keys())
    found = compare_values(*(np.array([side[seed] for seed in seeds]) for side in values))
    if found.difference is None:
        return ""
    text = f"{found.difference:+.2f}"
    if found.interval is not None:
        text += f" ({found.interval.low:+.2f} … {found.interval.high:+.2f})"
    return text


def markdown(found: Sequence[Cell]) -> str:
    """Return one table for each driver and each thing that hides people."""
    blocks = []
    for hidden_by, driver in dict.fromkeys((cell.hidden_by, cell.driver) for cell in found):
        mine = [cell for cell in found if (cell.hidden_by, cell.driver) == (hidden_by, driver)]
        base = next((cell for cell in mine if cell.seeing == BASE), None)
        lines = [f"### Hidden by {hidden_by}: {driver}", "", _line(_HEADS), _line(["---"] * len(_HEADS))]
        blocks.append("\n".join([*lines, *(_line(_texts(cell, base)) for cell in mine)]) + "\n")
    return "\n".join(blocks)


def draw(found: Sequence[Cell], path: Path) -> None:
    """Draw contacts and delay over latency, a row of pictures for each thing that hides people."""
    import matplotlib
    from matplotlib.figure import Figure

    colors = {"perfect": "#777777", "onboard": "#D55E00", "roadside": "#0072B2", "fused": "#009E73"}
    rows = list(dict.fromkeys(cell.hidden_by for cell in found))
    drivers = list(dict.fromkeys(cell.driver for cell in found))
    figure = Figure(figsize=(3.4 * len(drivers), 4.2 * len(rows)), layout="constrained")
    grid = figure.subplots(2 * len(rows), len(drivers), sharex=True, sharey="row", squeeze=False)
    for row, hidden_by in enumerate(rows):
        for column, driver in enumerate(drivers):
            share, delay = grid[2 * row, column], grid[2 * row + 1, column]
            share.set_title(f"{driver}\nhidden by {hidden_by}", loc="left", fontsize=8)
            for model in _ORDER:
                mine = [
                    cell
                    for cell in found
                    if (cell.hidden_by, cell.driver, cell.seeing[0]) == (hidden_by, driver, model)
                    and cell.encounters
                ]
                if not mine:
                    continue
                latency = [cell.seeing[1] for cell in mine]
                level = [cell.contacts / cell.encounters for cell in mine]
                late = [cell.delay for cell in mine]
                if latency == [None]:
                    share.axhline(level[0], color=colors[model], linestyle="--", label=model)
                    delay.axhline(late[0], color=colors[model], linestyle="--")
                    continue
                ends = [share_interval(cell.contacts, cell.encounters) for cell in mine]
                below = [one - end.low if end else 0.0 for one, end in zip(level, ends, strict=True)]
                above = [end.high - one if end else 0.0 for one, end in zip(level, ends, strict=True)]
                share.errorbar(
                    latency, level, [below, above], color=colors[model], marker="o", capsize=2, label=model
                )
                delay.plot(latency, late, color=colors[model], marker="o")
            delay.set_xlabel("latency_ms")
        grid[2 * row, 0].set_ylabel("contacts per encounter")
        grid[2 * row + 1, 0].set_ylabel("ego_delay_mean_s")
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    with matplotlib.rc_context({"svg.hashsalt": "cosim"}):
        figure.savefig(path, metadata={"Date": None})


def write_page(folder: Path, page: Path) -> None:
    """Write tables and figure of a study's folder.

    Raises
    ------
    StudyError
        If there are no runs in the folder, or they cannot be read.
    """
    folders = find_run_folders(folder)
    if not folders:
        raise StudyError(f"{folder}: no runs; cosim batch makes them")
    found = cells(read_runs(folders))
    figure = page.with_suffix(".svg")
    above = page.read_text("utf-8").partition(TABLES)[0].rstrip("\n") if page.exists() else "# Roadside"
    draw(found, figure)
    text = f"{above}\n\n{TABLES}\n\n![Contacts and delay over latency]({figure.name})\n\n{markdown(found)}"
    page.write_text(text, encoding="utf-8", newline="\n")


def _value(outcome: Outcome, what: str) -> float:
    return outcome.delay if what == "delay" else outcome.contacts / max(outcome.encounters, 1)


def _texts(cell: Cell, base: Cell | None) -> list[str]:
    model, latency = cell.seeing
    share = share_interval(cell.contacts, cell.encounters)
    told = np.concatenate([one.told for one in cell.outcomes]) if cell.outcomes else np.zeros(0)
    return [
        model,
        "" if latency is None else f"{latency:g}",
        f"{len(cell.outcomes)} of {cell.runs}",
        str(cell.encounters),
        f"**{cell.contacts}**",
        f"{cell.contacts / cell.encounters:.0%} ({share.low:.0%} … {share.high:.0%})" if share else "",
        str(sum(one.preventable for one in cell.outcomes)),
        f"{told.mean():.1f}" if len(told) else "",
        "" if cell.delay is None else f"{cell.delay:.1f}",
        against(cell, base, "contacts"),
        against(cell, base, "delay"),
    ]


def _line(texts: Sequence[str]) -> str:
    return "| " + " | ".join(texts) + " |"


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except StudyError as problem:
        sys.exit(f"cosim: {problem}")
