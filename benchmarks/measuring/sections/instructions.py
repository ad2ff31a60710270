"""Instruction counts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from analysis.markdown import table_of


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    counts = found["counts"]
    whole = counts.get("naive")
    rows = [
        {
            "control step": name,
            "million instructions": f"{count / 1e6:.1f}" if count else "took too long",
            "naive / it": f"{whole / count:.1f}" if count and whole else "",
        }
        for name, count in counts.items()
    ]
    return [
        "## Instructions",
        f"Valgrind's callgrind, {found['case']} (N/pedestrians), mean of {found['steps']} control steps from "
        f"number {found['first']} of one approach on; other load on the machine does not change the counts.",
        table_of(rows),
    ]
