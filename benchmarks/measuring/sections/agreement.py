"""Agreement of the naive programs with ours: the same problems."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from analysis.markdown import table_of


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    rows = [
        {
            "N/pedestrians, program": name,
            "programs": f"{s['programs']:.0f}",
            "objective, relative": f"{s['objective_difference']:.0e}",
            "first command": f"{s['first_command_difference']:.0e}",
            "OSQP error p99": f"{s['osqp_error_p99']:.0e}",
            "naive OSQP error p99": f"{s['naive_osqp_error_p99']:.0e}",
            "naive unsolved": f"{s['naive_unsolved']:.0f}",
        }
        for name, s in found["programs"].items()
    ]
    return [
        "## Agreement: the naive programs are the same problems",
        "Largest differences of the exact optima (DAQP) of both forms; and OSQP's errors of the first "
        "command (m/s², rad) against them, both at the controller's tolerance.",
        table_of(rows),
    ]
