"""Memory of a long run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from measuring.resident import table


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    settings = ", ".join(f"{key}={value}" for key, value in found["settings"].items())
    return [
        "## Memory over a simulated hour",
        f"`{found['scenario']}` with `{found['controller']}` ({found['solver']}) for a fifth of the cars, "
        f"{found['simulated_s']:g} simulated seconds in {found['took_s']:.0f} s ({settings}). After the "
        f"first {found['settled_s']:g} s memory grows by {found['mb_per_hour']:+.1f} MB per simulated hour, "
        f"the recording included. SUMO alone, stepping through the same demand, grows by "
        f"{found['alone_mb_per_hour']:+.1f} MB per hour and ends at {found['alone_end_mb']:.0f} MB.",
        table(found, 8, "simulated s", "{:.0f}".format),
    ]
