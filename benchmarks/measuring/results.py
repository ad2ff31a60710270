"""Where measured numbers are kept: a JSON file with all sections, and the page made from it."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent.parent
PACKAGES = ("numpy", "scipy", "osqp", "qpsolvers", "daqp", "libsumo")
LEAST_RATIO = 7.0
"""The bar: naive over ours at the median control step."""
BAR_CASE = "30/5"

Table = list[dict[str, Any]]


def publish(section: str, content: Mapping[str, Any]) -> None:
    """Replace one section of the results and write the page anew."""
    path = FOLDER / "results.json"
    everything = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    everything["environment"] = environment()
    everything[section] = content
    path.write_text(json.dumps(everything, indent=1) + "\n", encoding="utf-8")
    (FOLDER / "results.md").write_text(page(everything), encoding="utf-8")


def environment() -> dict[str, Any]:
    """Return what the numbers depend on, without naming the machine."""
    versions = {}
    for package in PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "not installed"
    return {"cores": os.cpu_count(), "python": platform.python_version(), "packages": versions}


def bar(steps: Mapping[str, Any]) -> list[str]:
    """Return one line per solver: the bar and the measured ratio beside it."""
    lines = []
    for solver, ratio in steps[BAR_CASE]["ratio"].items():
        spread = f"{ratio['least']:.1f} to {ratio['most']:.1f}; of total times {ratio['of_sums']:.1f} x"
        verdict = "met" if ratio["median"] >= LEAST_RATIO else "MISSED"
        lines.append(
            f"bar: at N = 30 with 5 pedestrians at least {LEAST_RATIO:g} x; "
            f"measured with {solver}: {ratio['median']:.1f} x "
            f"({spread}): {verdict}"
        )
    return lines


def page(everything: Mapping[str, Any]) -> str:
    """Return the results as Markdown."""
    about = everything["environment"]
    packages = ", ".join(f"{name} {number}" for name, number in about["packages"].items())
    parts = [
        "# Results of `make bench`",
        f"Python {about['python']}, {about['cores']} cores, one BLAS thread; {packages}. "
        "Milliseconds depend on the machine and on what else it does: compare ratios. "
        "How it is measured: [docs/performance.md](../docs/performance.md).",
    ]
    if "control_step" in everything:
        parts += _control_step(everything["control_step"])
    if "agreement" in everything:
        parts += _agreement(everything["agreement"])
    if "control_over_sumo" in everything:
        parts += _control_over_sumo(everything["control_over_sumo"])
    if "batch" in everything:
        parts += _batch(everything["batch"])
    return "\n\n".join(parts) + "\n"


def markdown(rows: Table) -> str:
    """Return rows with equal keys as a Markdown table."""
    heads = list(rows[0])
    lines = [heads, ["---"] * len(heads), *([str(row[head]) for head in heads] for row in rows)]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def _control_step(steps: Mapping[str, Any]) -> list[str]:
    whole, parts = [], []
    for case, entry in steps.items():
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
                    "programs per step": f"{entry['programs_per_step'][name]:.1f}",
                }
            )
            shares = entry["parts_ms"][name]
            parts.append(
                {"N/pedestrians": case, "control step": name}
                | {part: f"{value:.2f}" for part, value in shares.items()}
            )
    return [
        "## Control step: decide and plan",
        "\n".join(f"- {line}" for line in bar(steps)),
        markdown(whole),
        "Ratios of medians over the same perceptions, interleaved in one process; median, least and most of "
        "the repetitions; the ratio of total times beside it. "
        "By part, mean ms per control step (measured apart, with the clock's own cost):",
        markdown(parts),
    ]


def _agreement(found: Mapping[str, Mapping[str, float]]) -> list[str]:
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
        for name, s in found.items()
    ]
    return [
        "## Agreement: the naive programs are the same problems",
        "Largest differences of the exact optima (DAQP) of both forms; and OSQP's errors of the first "
        "command (m/s², rad) against them, both at the controller's tolerance.",
        markdown(rows),
    ]


def _control_over_sumo(loop: Mapping[str, Any]) -> list[str]:
    rows = [
        {
            "solver": solver,
            "egos per step": f"{entry['egos_per_step']:.2f}",
            **{f"{part} ms": f"{value:.3f}" for part, value in entry["ms_per_step"].items()},
            "control / SUMO's step": f"{entry['control_over_sumo']:.1f}",
            "sense / SUMO's step": f"{entry['sense_over_sumo']:.2f}",
        }
        for solver, entry in loop["solvers"].items()
    ]
    return [
        "## One loop with SUMO",
        f"`{loop['scenario']}`, {loop['steps']} steps of {loop['step_s']:g} s, on average "
        f"{loop['vehicles']:.0f} vehicles and {loop['persons']:.0f} persons in it; mean ms per step.",
        markdown(rows),
    ]


def batch_bars(found: Mapping[str, Any]) -> list[str]:
    """Return one line per bar of a batch, with the measured value beside it."""
    bars, one, two = found["bars"], found["jobs_1"], found["jobs_2"]
    overhead = 1.0 / one["throughput_ratio"] - 1.0
    memory = found["memory"]
    slope = memory["mb_per_100_runs"]
    spread = "{:.2f} to {:.2f}".format(min(two["throughput_ratios"]), max(two["throughput_ratios"]))
    return [
        f"bar: throughput with two processes at least {bars['least_throughput']:g} of two that share "
        f"the same runs; measured {two['throughput_ratio']:.2f} ({spread}) of two that call them in turn, "
        f"{two['throughput_ratio_shells']:.2f} of two shells that start cosim run for each: "
        f"{_verdict(two['throughput_ratio'] >= bars['least_throughput'])}",
        f"bar: overhead below {bars['most_overhead']:.0%} of the same runs called in turn in one process; "
        f"measured {overhead:+.1%} of wall-clock time, {one['cpu_ratio'] - 1.0:+.1%} of processor time: "
        f"{_verdict(overhead < bars['most_overhead'])}",
        f"bar: memory of a worker grows by less than {bars['most_mb_per_100_runs']:g} MB in 100 short runs, "
        f"over {memory['runs']}; measured {slope:+.2f} MB, its process replaced after every "
        f"{memory['runs_per_process']} runs ({memory['mb_per_100_runs_within_a_process']:+.2f} MB within a "
        f"process, most of it kept by SUMO): {_verdict(slope < bars['most_mb_per_100_runs'])}",
    ]


def _verdict(met: bool) -> str:
    return "met" if met else "MISSED"


def _batch(found: Mapping[str, Any]) -> list[str]:
    rows = [
        {"at a time": jobs, "runs": found[f"jobs_{jobs}"]["runs"]}
        | {f"{kind}, s": f"{value:.1f}" for kind, value in found[f"jobs_{jobs}"]["wall_s"].items()}
        | {f"{kind}, processor s": f"{value:.1f}" for kind, value in found[f"jobs_{jobs}"]["cpu_s"].items()}
        for jobs in (1, 2)
    ]
    return [
        "## A batch against plain processes",
        "\n".join(f"- {line}" for line in batch_bars(found)),
        f"Runs of {found['simulated_s']:g} simulated seconds, start and tables of the batch included; "
        f"medians of {found['rounds']} rounds in turns, shells once.",
        markdown(rows),
    ]
