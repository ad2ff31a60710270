"""The same plans by other means."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from analysis.markdown import table_of


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    rows = []
    for name, time in found["median_ms"].items():
        of = found["ratio"].get(name)
        rows.append(
            {"plan of one class by": name, "median ms": f"{time:.2f}"}
            | {
                f"over ours, {solver}": f"{of[solver]['median']:.0f} ({of[solver]['least']:.0f} to "
                f"{of[solver]['most']:.0f})"
                if of
                else ""
                for solver in next(iter(found["ratio"].values()))
            }
        )
    text = [
        f"{found['case']} (N/pedestrians), {found['steps']} control steps of {found['repetitions']} "
        "repetitions; ratios of medians, with least and most of the repetitions."
    ]
    if "agreement" in found:
        agreed = found["agreement"]
        text.append(
            f"IPOPT needs {found['ipopt_iterations']:.0f} iterations in the median and gave up "
            f"{found['ipopt_unsolved']} times. Over {agreed['compared']:.0f} plans its optimum and ours, "
            f"with the braking distance settled, differ by at most {agreed['speed_mps']:.1e} m/s, "
            f"{agreed['steering_rad']:.1e} rad and {agreed['cost_relative']:.1e} of the cost."
        )
    if "genetic_excess" in found:
        text.append(
            "The genetic algorithm (50 individuals, 100 generations) ends at a cost that is higher than ours "
            f"by {found['genetic_excess']:.0%} of it in the median."
        )
    return ["## Other methods", table_of(rows), " ".join(text)]
