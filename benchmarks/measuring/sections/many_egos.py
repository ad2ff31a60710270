"""Many egos in one network."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from analysis.markdown import table_of


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    rows = [
        {
            "egos": f"{run['egos']:.0f}",
            "solver": run["solver"],
            "vehicles, persons": f"{run['vehicles']:.0f}, {run['persons']:.0f}",
            "x real time": f"{run['real_time_factor']:.2f}",
            "control per ego and step, ms": f"{run['control_ms_per_ego_and_step']:.2f}",
            "all per ego and step, ms": f"{run['ms_per_ego_and_step']:.2f}",
        }
        | {
            f"{'decide + plan' if part == 'rest' else part} ms": f"{value:.1f}"
            for part, value in run["ms_per_step"].items()
        }
        for run in found["runs"]
    ]
    return [
        "## Many egos in one network",
        "A grid city, every ego with `vo_mpc` as it is by default, planning every 0.1 s; each run in a "
        "process of its own on one core, recording included; mean ms per step, after all have departed. "
        "Numbers of egos are means, because an ego leaves the road at the end of its route.",
        table_of(rows),
    ]
