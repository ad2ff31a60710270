"""Drives the controllers through one town, in a separate batch with separate processes and time limits."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from cosim.batches.study import study_of, study_text
from studies.zoo import town
from studies.zoo.catalog import Plan
from studies.zoo.programs import ZooError
from studies.zoo.recipe import Recipe

TOWN, RESULTS, STATE, LOG = "town", "results", "state.json", "log.txt"
START_S = 900.0
"""A batch may take this long in addition to its runs [s]."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a batch."""

    jobs: int = 2
    """Number of runs at a time."""
    run_timeout_s: float = 900.0
    """Longest wall-clock time of a run [s]."""
    keep_recordings: bool = False


def is_done(folder: Path) -> bool:
    """Return whether all runs of a network have been tried."""
    return (folder / STATE).exists()


def drive(recipe: Recipe, plan: Plan, limits: Limits, folder: Path) -> None:
    """Make a town and all its runs; a problem is written as one line into ``state.json``.

    Parameters
    ----------
    recipe : Recipe
    plan : Plan
    limits : Limits
    folder : Path
        Folder of this network; the call goes on with what an interrupted one left there.
    """
    folder.mkdir(parents=True, exist_ok=True)
    try:
        configuration = town.make(recipe, plan.seed, plan.duration_s, folder / TOWN)
        code, said = _batch(configuration.relative_to(folder), recipe, plan, limits, folder)
    except ZooError as error:
        code, said = 2, str(error)
    state = {"code": code, "said": said}
    (folder / STATE).write_text(json.dumps(state, ensure_ascii=False) + "\n", "utf-8")


def seeds_of(recipe: Recipe, plan: Plan) -> list[int]:
    """Return the seeds of a network's runs; one for a ready-made configuration, which only has to run."""
    return plan.run_seeds()[:1] if recipe.as_it_is else plan.run_seeds(recipe.run_factor)


def _batch(configuration: Path, recipe: Recipe, plan: Plan, limits: Limits, folder: Path) -> tuple[int, str]:
    """Call ``cosim batch`` and return its exit code and its last line."""
    seeds = seeds_of(recipe, plan)
    content = {
        "scenarios": [str(configuration)],
        "controllers": list(plan.controllers),
        "seeds": seeds,
        "set": {"duration_s": plan.duration_s, "ego_share": plan.ego_share},
        "run_timeout_s": limits.run_timeout_s,
    }
    study = folder / "study.toml"
    study.write_text(study_text(study_of(content, str(study))), "utf-8")
    words = ["batch", study.name, "--out", RESULTS, "--jobs", str(limits.jobs)]
    if not limits.keep_recordings:
        words.append("--drop-recordings")
    most_s = START_S + len(seeds) * len(plan.controllers) * limits.run_timeout_s
    with (folder / LOG).open("w", encoding="utf-8") as log:
        try:
            done = subprocess.run(
                cosim(*words),
                cwd=folder,
                env=environment(),
                stdout=log,
                stderr=log,
                timeout=most_s,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return 3, f"cosim batch was not done after {most_s:g} s"
    lines = (folder / LOG).read_text("utf-8", errors="replace").strip().splitlines()
    return done.returncode, lines[-1].removeprefix("cosim: ") if lines else ""


def cosim(*words: str) -> list[str]:
    """Return the command line of ``cosim`` with this Python."""
    return [sys.executable, "-m", "cosim.cli", *words]


def environment() -> dict[str, str]:
    """Return an environment in which ``cosim`` is found from any folder."""
    root = str(Path(__file__).resolve().parents[2])
    others = os.environ.get("PYTHONPATH", "")
    return {**os.environ, "PYTHONPATH": f"{root}{os.pathsep}{others}" if others else root}
