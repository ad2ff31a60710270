"""A batch against plain processes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from analysis.markdown import table_of


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    rows = [
        {"at a time": jobs, "runs": found[f"jobs_{jobs}"]["runs"]}
        | {f"{kind}, s": f"{value:.1f}" for kind, value in found[f"jobs_{jobs}"]["wall_s"].items()}
        | {f"{kind}, processor s": f"{value:.1f}" for kind, value in found[f"jobs_{jobs}"]["cpu_s"].items()}
        for jobs in (1, 2)
    ]
    shells = " and ".join(str(found[f"jobs_{jobs}"]["shell_runs"]) for jobs in (1, 2))
    return [
        "## A batch against plain processes",
        f"Runs of {found['simulated_s']:g} simulated seconds, start and tables of the batch included; "
        f"medians of {found['rounds']} rounds in turns. Shells once, reckoned from {shells} runs.",
        table_of(rows),
    ]
