"""Growth of the control step with the size of the problem."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from analysis.markdown import table_of


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    text = ["## Growth: horizon and pedestrians"]
    for name in ("horizon", "pedestrians"):
        rows = [
            {"N/pedestrians": case}
            | {f"{s}, median ms": f"{one['median_ms']:.2f}" for s, one in entry.items()}
            | {f"{s}, mean ms": f"{one['mean_ms']:.2f}" for s, one in entry.items()}
            for case, entry in found[name].items()
        ]
        laws = "; ".join(
            f"{solver}: exponent {k['median_ms']:.2f} of the median, {k['mean_ms']:.2f} of the mean"
            for solver, k in found[f"{name}_exponent"].items()
        )
        since = f" from {found['fewest_people']} on" if name == "pedestrians" else ""
        text += [table_of(rows), f"Law of growth with {name}{since}, cost ~ size^k: {laws}."]
    return text
