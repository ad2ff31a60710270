"""What compiled arithmetic costs before it pays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    return [
        "## Compiled arithmetic",
        f"`compiled=true` takes {found['first_s']:.1f} s when it is used for the first time in an "
        f"installation, and {found['later_s']:.2f} s at the start of every process after that. "
        f"A control step ({found['case']}, N/pedestrians) is {found['saved_per_step_ms']:.2f} ms shorter in "
        f"the mean than with required packages, so a process has its start back after "
        f"{found['later_pays_after_steps']:.0f} control steps, and an installation the compiling after "
        f"{found['first_pays_after_steps']:.0f}.",
    ]
