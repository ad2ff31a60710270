"""Writes the failures found as scenarios, which ``cosim run`` and ``cosim check`` take."""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from analysis.files import write_text
from analysis.search.axes import Point
from analysis.search.kinds import Failure, Kind
from analysis.search.results import KindRow
from controllers.outside.addresses import is_address
from cosim.batches.study import study_of, study_text
from cosim.search.shrinking import Shrunk
from cosim.search.subject import Subject
from cosim.search.trials import Trial, copy_scenario

FAILURES = "failures"
OF_KIND = 3
"""Number of failures of each kind that become scenarios, the clearest ones."""


def write_suite(
    subject: Subject,
    folder: Path,
    found: Sequence[Kind],
    seedless: Callable[[Point], Point],
    changes: Mapping[int, Shrunk],
) -> list[KindRow]:
    """Write the clearest failures of each kind below ``folder``, and a study file for each seed.

    Parameters
    ----------
    subject
    folder
        Folder of the search.
    found
        Kinds of failures.
    seedless
        Removes the seed from a point.
    changes
        Smallest changes by the number of the kind.

    Returns
    -------
    list
        The kinds with their scenarios and commands.
    """
    suite = folder / FAILURES
    shutil.rmtree(suite, ignore_errors=True)
    rows = []
    by_seed: dict[int, list[str]] = {}
    for number, kind in enumerate(found, 1):
        names = [scenario_name(number, one) for one in kind.failures[:OF_KIND]]
        for name, one in zip(names, kind.failures, strict=False):
            description = f"{subject.controller} failed: {kind.name}"
            copy_scenario(subject, Trial(name, seedless(one.point), one.seed, description), suite / name)
            by_seed.setdefault(one.seed, []).append(name)
        scenario = suite / names[0]
        shrunk = changes.get(number)
        rows.append(
            KindRow(
                number,
                kind,
                f"{FAILURES}/{names[0]}",
                run_command(subject, scenario, kind.worst.seed),
                "" if shrunk is None or shrunk.change is None else shrunk.change.in_words(),
                0 if shrunk is None else shrunk.runs,
            )
        )
    for seed, names in by_seed.items():
        content: dict[str, object] = {
            "scenarios": names,
            "controllers": [subject.controller],
            "seeds": [seed],
        }
        if subject.controller_settings:
            content["set"] = dict(subject.controller_settings)
        write_text(suite / f"seed-{seed}.toml", study_text(study_of(content, f"seed-{seed}.toml")))
    return rows


def scenario_name(number: int, failure: Failure) -> str:
    """Return the name of the scenario of a failure, given the number of its kind."""
    return f"kind-{number:02d}-trial-{failure.trial:04d}" + (
        f"-seed-{failure.seed}" if failure.seed != 1 else ""
    )


def run_command(subject: Subject, scenario: Path, seed: int) -> str:
    """Return the command that repeats a failure."""
    words = ["cosim", "run", str(scenario), "--controller", subject.controller, "--seed", str(seed)]
    for key, text in subject.controller_settings:
        words += ["--set", f"{key}={text}"]
    return shlex.join(words)


def check_command(controller: str, folder: Path) -> str:
    """Return the command that checks all failures in the folder of a search.

    The command names a controller that is a program, as the files of a suite must not start one.
    """
    words = ["cosim", "check", str(folder / FAILURES)]
    if is_address(controller):
        words += ["--controller", controller]
    return shlex.join(words)
