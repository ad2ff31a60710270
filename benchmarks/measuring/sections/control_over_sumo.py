"""One ego in a loop with SUMO."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from analysis.markdown import table_of


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    rows, parts = [], []
    for name, city in found["cities"].items():
        for solver, one in city["solvers"].items():
            ratio = one["control_over_advance"]
            rows.append(
                {"vehicles/persons": name, "solver": solver}
                | {
                    f"{'decide + plan' if part == 'rest' else part} ms": f"{value:.3f}"
                    for part, value in one["ms_per_step"].items()
                }
                | {
                    "control / advance()": f"{ratio['median']:.2f} "
                    f"({ratio['least']:.2f} to {ratio['most']:.2f})",
                    "SUMO without an ego, ms": f"{city['sumo_alone_ms']:.3f}",
                    "control / that": f"{one['control_over_sumo_alone']['median']:.2f}",
                }
            )
            parts.append(
                {"vehicles/persons": name, "solver": solver}
                | {part: f"{v['median_ms']:.2f}, {v['p99_ms']:.2f}" for part, v in one["parts"].items()}
            )
    city = next(iter(found["cities"].values()))
    return [
        "## One ego in a loop with SUMO",
        f"A grid city, hybrid actuation, {found['horizon']} intervals, {city['steps']} steps of "
        f"{city['step_s']:g} s after all vehicles and persons have departed; mean ms per step, "
        "medians of the repeats. "
        "*Control* is sense, decide, plan and act; `advance()` is *advance* and *SUMO's step* together. "
        "SUMO without an ego: the same configuration in a loop that does nothing but step.",
        table_of(rows),
        "The same by part, median and 99th percentile in ms (measured apart, with the clock's own cost):",
        table_of(parts),
    ]
