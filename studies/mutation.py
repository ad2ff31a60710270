"""Checks whether the tests notice faults: runs random mutants against the tests of their own place.

``python -m studies.mutation plant --count 15 --seed 1`` (extra ``mutation``) prints the outcome of each
mutant and a row of the table in ``docs/testing.md``. It changes only a copy of the repository.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

from cosmic_ray.ast import get_ast_from_path
from cosmic_ray.commands.init import init
from cosmic_ray.mutating import mutate_and_test, mutate_code
from cosmic_ray.plugins import get_operator
from cosmic_ray.testing import run_tests
from cosmic_ray.work_db import use_db
from cosmic_ray.work_item import MutationSpec, TestOutcome

from analysis.markdown import table

ROOT = Path(__file__).resolve().parents[1]
NOT_COPIED = (".git", ".venv", "runs", "build", "__pycache__", ".*_cache", ".hypothesis", "*.egg-info")
TIME_LIMIT = 600.0
"""Time limit for the tests of one mutant; a mutant that takes longer counts as killed [s]."""


class Place(NamedTuple):
    """Code to mutate and tests that should notice it: patterns of paths; those of tests match one each."""

    sources: tuple[str, ...]
    tests: tuple[str, ...]


PLACES = {
    "metrics": Place(
        ("analysis/metrics/*.py", "analysis/encounters/*.py"),
        ("tests/analysis/metrics", "tests/analysis/encounters"),
    ),
    "passing": Place(
        (
            "controllers/conflicts/path_conflicts.py",
            "controllers/conflicts/expected_behaviour.py",
            "controllers/conflicts/band_overlap.py",
            "controllers/velocity_obstacle/mpc/passing_classes.py",
            "controllers/velocity_obstacle/mpc/arithmetic/passing_bounds.py",
        ),
        tuple(
            f"tests/controllers/**/test_{name}.py"
            for name in (
                "path_conflicts",
                "passing_classes",
                "horizon",
                "longitudinal",
                "bystanders",
                "way_out",
            )
        ),
    ),
    "search": Place(("analysis/search/*.py",), ("tests/analysis/search",)),
    "validation": Place(("analysis/validation/*.py",), ("tests/analysis/validation",)),
    "yielding": Place(("controllers/yielding/*.py",), ("tests/controllers/yielding",)),
    "boxes": Place(("controllers/geometry/box_clearances.py",), ("tests/controllers/geometry",)),
    "plant": Place(("cosim/step/plant.py", "cosim/step/frames.py"), ("tests/cosim/step",)),
    "statistics": Place(
        ("analysis/statistics/*.py", "analysis/study/*.py"),
        ("tests/analysis/statistics", "tests/analysis/study"),
    ),
}


def drawn(place: Place, count: int, seed: int, folder: Path) -> list[MutationSpec]:
    """Return mutants of the copy in the current folder; a larger count adds to the same mutants."""
    files = sorted(file for pattern in place.sources for file in Path().glob(pattern))
    with use_db(str(folder / "mutants.sqlite")) as database:
        init(files, database, {})
        offered = [item.mutations[0] for item in database.work_items]
    offered.sort(key=lambda one: (one.module_path, one.start_pos, one.operator_name, one.occurrence))
    random.Random(seed).shuffle(offered)
    trees = {file: get_ast_from_path(file) for file in files}
    chosen: list[MutationSpec] = []
    for one in offered:
        if len(chosen) < count and not _says_nothing(trees[one.module_path], one) and _is_python(one):
            chosen.append(one)
    return chosen


def _says_nothing(tree: Any, mutant: MutationSpec) -> bool:
    """Return whether a mutant changes only an annotation or a raise statement."""
    node = tree.get_leaf_for_position(mutant.start_pos)
    while node.parent is not None:
        inside, node = node, node.parent
        annotation = {"annassign": 1, "tfpdef": 2}.get(node.type)
        if node.type == "raise_stmt" or (node.type == "funcdef" and inside is node.annotation):
            return True
        if annotation is not None and inside is node.children[annotation]:
            return True
    return False


def _is_python(mutant: MutationSpec) -> bool:
    operator = get_operator(mutant.operator_name)()
    try:
        compile(mutate_code(mutant.module_path.read_text("utf-8"), operator, mutant.occurrence), "", "exec")
    except SyntaxError:
        return False
    return True


def survivors(place: Place, mutants: list[MutationSpec]) -> int:
    """Test each mutant, print the outcome and return how many survived."""
    tests = [_found(pattern) for pattern in place.tests]
    command = " ".join([sys.executable, "-m pytest -x -q -n 0 -p no:cacheprovider -m 'not slow'", *tests])
    unchanged, output = run_tests(command, TIME_LIMIT)
    if unchanged is not TestOutcome.SURVIVED:
        raise SystemExit(f"the tests fail without a mutant:\n{output}")
    count = 0
    for number, mutant in enumerate(mutants, 1):
        result = mutate_and_test([mutant], command, TIME_LIMIT)
        if result.test_outcome is TestOutcome.INCOMPETENT:
            raise SystemExit(result.output)
        count += not result.is_killed
        killer = re.search(r"^(FAILED|ERROR) (.*)", result.output or "", re.MULTILINE)
        where = f"{mutant.module_path}:{mutant.start_pos[0]}"
        print(f"{number} {result.test_outcome.value} {where} {mutant.operator_name}", flush=True)
        print(result.diff if not result.is_killed else killer and killer[2], flush=True)
    return count


def _found(pattern: str) -> str:
    """Return the only path of a pattern; it must exist, since without paths pytest would run all tests."""
    (path,) = Path().glob(pattern)
    return str(path)


def main() -> None:
    """Draw mutants in a copy of the repository and test them."""
    parser = argparse.ArgumentParser(description="Mutants against the tests of their own place.")
    parser.add_argument("places", nargs="*", choices=list(PLACES), help="all of them by default")
    parser.add_argument("--count", type=int, default=15, help="mutants per place")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "repository"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(*NOT_COPIED))
        os.chdir(copy)
        # With CI set, hypothesis draws the same examples every time and has no deadline.
        os.environ |= {"PYTHONPATH": str(copy), "CI": "true"}
        for name in given.places or PLACES:
            mutants = drawn(PLACES[name], given.count, given.seed, Path(folder))
            alive = survivors(PLACES[name], mutants)
            rows.append([name, str(len(mutants)), str(len(mutants) - alive), str(alive)])
    print(table(["place", "mutants", "killed", "survived"], rows))


if __name__ == "__main__":
    main()
