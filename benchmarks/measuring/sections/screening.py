"""Closed-loop safety with and without the short cuts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from measuring.markdown import table


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    rows = [
        {
            "scenario": scenario,
            "measure": key,
            "pairs": one["pairs"],
            "mean": f"{one['mean']:.3f}",
            "difference": f"{one['difference']:+.1e}",
            "95 % interval": f"{one['low']:+.1e} to {one['high']:+.1e}",
            "width": f"{one['high'] - one['low']:.1e}",
            "largest of a pair": f"{one['largest']:.1e}",
        }
        for scenario, entry in found["scenarios"].items()
        for key, one in entry["measures"].items()
        if one["pairs"]
    ]
    far = ", ".join(f"{name} {entry['apart_m']:.1e} m" for name, entry in found["scenarios"].items())
    return [
        "## Closed-loop safety against the full problem",
        f"The same seeds with `{found['solver']}`, {found['driven_s']:g} s driven: with the short cuts, and "
        "with every program handed to the solver with all its rows. The same ego at the same time is at most "
        f"this far apart: {far}.",
        table(rows),
    ]
