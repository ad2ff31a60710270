"""What it costs to record and judge everybody."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from measuring.resident import table


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    return [
        "## Recording and judging everybody",
        f"`{found['scenario']}` without egos, {found['simulated_s']:g} simulated seconds: simulating and "
        f"recording take {found['simulation_cpu_s']:.1f} s of processor time, judging "
        f"{found['judging_cpu_s']:.1f} s, {found['share_percent']:.0f} % of it, and at most "
        f"{found['judging_most_mb']:.0f} MB. The recording of everybody takes "
        f"{found['mb_per_hour']:.1f} MB per simulated hour. While it is made, resident memory changes by "
        f"{found['growth_mb_per_hour']:+.0f} MB per simulated hour; judging reads the whole "
        "recording at once.",
        table(found, 8, "simulated s", "{:.0f}".format),
    ]
