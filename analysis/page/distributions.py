"""Small multiples of cumulative distributions, as SVG in the colours of the page, light or dark."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from analysis.arrays import FloatArray
from analysis.page.encounters import Encounters
from analysis.study.design import Study
from analysis.thresholds import DRAC_LIMIT_MPS2, LOW_PET_S, LOW_TTC_S

POINTS = 200
"""A curve with more values than this is drawn through this many of its percentiles."""
SERIES = 6
"""Number of colours of the page; line 7 has the colour of line 1, but other dashes."""
_DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (2, 1.5)), (0, (7, 2, 1.5, 2)))
# Placeholder colours, replaced by the variables of page.css in the finished SVG.
_INK, _MUTED, _GRID = "#010203", "#010204", "#010205"
_LINE = "#0102{:02x}"
_VARIABLES = {_INK: "var(--ink)", _MUTED: "var(--muted)", _GRID: "var(--grid)"} | {
    _LINE.format(16 + i): f"var(--series-{i + 1})" for i in range(SERIES)
}


@dataclass(frozen=True, slots=True)
class Panel:
    """One quantity of the small multiples."""

    column: str
    title: str
    unit: str
    limit: float | None = None
    """Where a line for comparison is drawn."""
    most: float | None = None
    """End of the axis; larger values do not matter for safety."""
    file: str = "encounters.csv"


PANELS = (
    Panel("min_ttc_s", "Smallest TTC", "s", LOW_TTC_S, 8.0),
    Panel("pet_area_s", "PET", "s", LOW_PET_S, 8.0),
    Panel("min_dist_m", "Smallest distance", "m", None, 20.0),
    Panel("ego_max_decel_mps2", "Largest deceleration of the ego", "m/s²", DRAC_LIMIT_MPS2),
    Panel("ego_delay_mean_s", "Mean delay of the egos of a run", "s", file="runs.csv"),
    Panel("ped_delay_s", "Delay of the pedestrian", "s"),
)


def distributions(study: Study, found: Encounters) -> list[dict[str, Any]]:
    """Return the panels for each scenario, with the runs of all its settings together."""
    blocks = []
    labels = study.all_labels()
    for place, scenario in enumerate(sorted({run.scenario_id for run in study.runs})):
        values = {label: _values(study, found, scenario, label) for label in labels}
        present = [label for label in labels if values[label]]
        if not present:
            continue
        panels = []
        for number, panel in enumerate(PANELS):
            series = {label: values[label][panel.column] for label in present}
            panels.append(
                {
                    "title": panel.title,
                    "unit": panel.unit,
                    "column": panel.column,
                    "file": panel.file,
                    "limit": panel.limit,
                    "svg": _figure(panel, series, labels, f"d{place}-{number}-"),
                    "counts": [
                        {
                            "name": label,
                            "defined": len(series[label]),
                            "of": values[label]["runs" if panel.file == "runs.csv" else "encounters"].size,
                        }
                        for label in present
                    ],
                }
            )
        blocks.append(
            {"scenario": scenario, "panels": panels, "legend": [_legend(labels, one) for one in present]}
        )
    return blocks


def _values(study: Study, found: Encounters, scenario: str, label: str) -> dict[str, FloatArray]:
    """Return the sorted defined values for each panel; empty for a configuration without a valid run."""
    runs = [
        (i, run)
        for i, run in enumerate(found.runs)
        if run.scenario_id == scenario and study.label(run) == label
    ]
    if not runs:
        return {}
    own = np.isin(found.owner, [i for i, _ in runs])
    values = {"encounters": np.zeros(int(own.sum())), "runs": np.zeros(len(runs))}
    for panel in PANELS:
        if panel.file == "runs.csv":
            all_of_it = np.array([run.numbers.get(panel.column, np.nan) for _, run in runs])
        else:
            all_of_it = found.numbers[panel.column][own]
        values[panel.column] = np.sort(all_of_it[np.isfinite(all_of_it)])
    return values


def _legend(labels: Sequence[str], label: str) -> dict[str, Any]:
    at = labels.index(label)
    dash = _DASHES[at % len(_DASHES)]
    return {
        "name": label,
        "series": at % SERIES + 1,
        "dashes": "" if dash == "-" else " ".join(f"{1.8 * part:g}" for part in dash[1]),
    }


def _figure(panel: Panel, series: Mapping[str, FloatArray], labels: Sequence[str], prefix: str) -> str:
    # Text stays text, and the names of clip paths are the same on every call.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "cosim", "font.size": 9.0}):
        figure = Figure(figsize=(3.7, 2.35), layout="constrained")
        FigureCanvasSVG(figure)
        figure.patch.set_visible(False)
        axes = figure.add_subplot()
        axes.patch.set_visible(False)
        for label, values in series.items():
            at = labels.index(label)
            x, y = _steps(values)
            axes.step(
                x,
                y,
                where="post",
                color=_LINE.format(16 + at % SERIES),
                linestyle=_DASHES[at % len(_DASHES)],
                linewidth=1.8,
            )
        if panel.limit is not None:
            axes.axvline(panel.limit, color=_MUTED, linewidth=0.9, linestyle=(0, (1, 2)))
        high = max([float(values[-1]) for values in series.values() if len(values)], default=1.0)
        low = min([float(values[0]) for values in series.values() if len(values)], default=0.0)
        if panel.most is not None:
            high = min(high, panel.most)
        high = max(high, (panel.limit or 0.0) * 1.3, low + 1e-3)
        axes.set_xlim(min(0.0, low), high + 0.03 * (high - low))
        axes.set_ylim(0.0, 1.02)
        axes.set_yticks([0.0, 0.5, 1.0], ["0", "50 %", "100 %"])
        axes.set_xlabel(f"{panel.title} [{panel.unit}]", color=_INK)
        axes.tick_params(colors=_MUTED, labelcolor=_MUTED, length=3)
        axes.grid(color=_GRID, linewidth=0.7)
        axes.set_axisbelow(True)
        for side, spine in axes.spines.items():
            spine.set_visible(side in ("left", "bottom"))
            spine.set_color(_GRID)
        if not any(len(values) for values in series.values()):
            axes.text(0.5, 0.5, "no value", transform=axes.transAxes, ha="center", va="center", color=_MUTED)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    description = f"{panel.title}: share of values at or below, one line for each configuration"
    return _inline(text.getvalue(), prefix, description)


def _steps(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the steps of the cumulative distribution, from 0 to 1."""
    if len(values) == 0:
        return np.zeros(0), np.zeros(0)
    if len(values) > POINTS:
        share = np.linspace(0.0, 1.0, POINTS)
        return np.quantile(values, share), share
    share = np.arange(1, len(values) + 1) / len(values)
    return np.concatenate([values[:1], values]), np.concatenate([[0.0], share])


def _inline(svg: str, prefix: str, description: str) -> str:
    """Return a drawing for use inside a page: with its own ids, the page's colours, and nothing to load."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.S)
    svg = re.sub(r"<style.*?</style>\s*", "", svg, flags=re.S)  # would style the page too
    svg = re.sub(r"<!--.*?-->\s*", "", svg, flags=re.S)
    svg = re.sub(r' xmlns(:\w+)?="[^"]*"', "", svg)
    svg = svg.replace("xlink:href", "href")
    svg = re.sub(r' id="', f' id="{prefix}', svg)
    svg = svg.replace("url(#", f"url(#{prefix}").replace('href="#', f'href="#{prefix}')
    svg = re.sub(r"font(-family)?: [^;\"]*'[^;\"]*", _font, svg)
    svg = re.sub(r' (width|height)="[\d.]+pt"', "", svg, count=2)
    for colour, variable in _VARIABLES.items():
        svg = svg.replace(colour, variable)
    return svg.replace("<svg ", f'<svg role="img" aria-label="{description}" ', 1).strip()


def _font(match: re.Match[str]) -> str:
    """Return the style with the font's size only, so that the page sets the family."""
    size = re.search(r"([\d.]+)px", match.group(0))
    return f"font-size: {size.group(1)}px" if size else "font-family: inherit"
