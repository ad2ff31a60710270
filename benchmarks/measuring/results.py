"""The files of measured numbers: JSON with all sections, and the page made from it."""

from __future__ import annotations

import importlib
import json
import os
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from analysis.markdown import table_of
from measuring.bars import Bar

FOLDER = Path(__file__).resolve().parent.parent
BUSY = 1.5
"""Load average above which other programs were at work: one benchmark at a time runs, on one core."""
PACKAGES = ("numpy", "scipy", "osqp", "qpsolvers", "daqp", "libsumo", "casadi", "pymoo")
SECTIONS = (
    "control_step",
    "agreement",
    "other_methods",
    "growth",
    "control_over_sumo",
    "many_egos",
    "memory",
    "judging_everybody",
    "endurance",
    "instructions",
    "batch",
)
"""In the order of the page; ``measuring.sections`` has a module for each."""


def publish(section: str, content: Mapping[str, Any], bars: Sequence[Bar], folder: Path | None) -> None:
    """Replace one section of the results in a folder and write the page anew; nothing without a folder."""
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "results.json"
    everything = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    everything["environment"] = environment()
    everything[section] = {**content, "bars": [bar.entry() for bar in bars], "load": os.getloadavg()[0]}
    # Sections of earlier code that this code cannot show are dropped.
    everything = {name: one for name, one in everything.items() if name not in SECTIONS or _shown(name, one)}
    path.write_text(json.dumps(everything, indent=1) + "\n", encoding="utf-8")
    (folder / "results.md").write_text(page(everything), encoding="utf-8")


def environment() -> dict[str, Any]:
    """Return the versions and the number of cores; the machine is not named."""
    versions = {}
    for package in PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "not installed"
    return {"cores": os.cpu_count(), "python": platform.python_version(), "packages": versions}


def all_bars(everything: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the bars of all sections, in the order of the page."""
    return [bar for name in SECTIONS for bar in everything.get(name, {}).get("bars", ())]


def page(everything: Mapping[str, Any]) -> str:
    """Return the results as Markdown."""
    about = everything["environment"]
    packages = ", ".join(f"{name} {number}" for name, number in about["packages"].items())
    parts = [
        "# Results of `make bench`",
        f"Python {about['python']}, {about['cores']} cores, one BLAS thread; {packages}. "
        "Milliseconds depend on the machine and its load: compare ratios. "
        "The method is described in [docs/performance.md](../docs/performance.md).",
    ]
    measured = [name for name in SECTIONS if name in everything]
    busy = [name for name in measured if everything[name].get("load", float("inf")) > BUSY]
    if busy:
        parts.append(
            f"**The machine was busy** (load average above {BUSY:g}, or not known) while these sections were "
            f"measured, so their times and spreads are unreliable: {', '.join(busy)}."
        )
    if bars := all_bars(everything):
        heads = ("what", "bar", "measured", "verdict", "note")
        parts += ["## Bars", table_of([{head: bar[head] for head in heads} for bar in bars])]
    for name in measured:
        parts += _paragraphs(name, everything[name])
    return "\n\n".join(parts) + "\n"


def _paragraphs(name: str, content: Mapping[str, Any]) -> list[str]:
    return list(importlib.import_module(f"measuring.sections.{name}").paragraphs(content))


def _shown(name: str, content: Mapping[str, Any]) -> bool:
    try:
        _paragraphs(name, content)
    except KeyError:
        return False
    return True
