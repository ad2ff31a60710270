"""Times of the control step, by part and against the naive one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from analysis.markdown import table_of


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    whole, parts, programs = [], [], []
    for case, entry in found["cases"].items():
        for name, times in entry["times"].items():
            ratio = entry["ratio"].get(name)
            whole.append(
                {
                    "N/pedestrians": case,
                    "control step": name,
                    "median ms": f"{times['median_ms']:.2f}",
                    "p95 ms": f"{times['p95_ms']:.2f}",
                    "p99 ms": f"{times['p99_ms']:.2f}",
                    "naive / it": f"{ratio['median']:.1f} ({ratio['least']:.1f} to {ratio['most']:.1f})"
                    if ratio
                    else "1",
                    "of sums": f"{ratio['of_sums']:.1f}" if ratio else "1",
                }
            )
        for name, split in entry["parts"].items():
            parts.append(
                {"N/pedestrians": case, "control step": name}
                | {part: f"{v['median_ms']:.2f}, {v['p99_ms']:.2f}" for part, v in split.items()}
            )
        for name, solves in entry["programs"].items():
            programs.append(
                {
                    "N/pedestrians": case,
                    "solver": name,
                    "programs per step": f"{solves['per_step']:.1f}",
                    "unsolved": solves["unsolved"],
                    "speed program, median µs": f"{1e3 * solves['speed']['median_ms']:.0f}",
                    "p99 µs": f"{1e3 * solves['speed']['p99_ms']:.0f}",
                    "p99 / median": f"{solves['speed']['p99_over_median']:.1f}",
                    "of medians": f"{solves['speed']['p99_over_median_quiet']:.1f}",
                    "steering program, median µs": f"{1e3 * solves['steering']['median_ms']:.0f}",
                }
            )
    growth = [
        {
            "solver": name,
            "steps": entry["steps"],
            "bytes still held, per 1000 steps": f"{entry['bytes_per_1000_steps']:.0f}",
            "held between first and last look": entry["bytes_after_last"] - entry["bytes_after_first"],
            "peak of a step, median kB": f"{entry['peak_median_kb']:.0f}",
            "largest kB": f"{entry['peak_most_kb']:.0f}",
        }
        for name, entry in found["allocations"].items()
    ]
    return [
        "## Control step: decide and plan",
        table_of(whole),
        "Ratios of medians over the same perceptions, interleaved in one process; median, least and most of "
        "the repetitions; the ratio of total times beside it. "
        "By part, median and 99th percentile in ms (measured apart, with the clock's own cost); sensing, "
        "acting and recording are in the section about the loop with SUMO:",
        table_of(parts),
        "Programs: how many, and how long it takes to solve one and to check its certificate. "
        "The 99th percentile is over every solve of every repetition; *of medians*: each program's median "
        "over the repetitions first, which leaves out the effect of other load on the machine.",
        table_of(programs),
        "Memory of the control step (tracemalloc), after a warm-up, at 30 intervals and 5 pedestrians; a "
        "step's peak is what it has allocated at most at one time.",
        table_of(growth),
    ]
