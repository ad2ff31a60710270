"""Finds the papers' experiments: each subpackage here has a module ``experiments``.

The module defines the number of the ``PAPER``, its ``TITLE`` and the function ``run``.
"""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import studies.papers
from cosim.errors import InputError
from studies.papers.claim import Claim

EXTRA = ("matplotlib", "pymoo")
"""Packages of the extra ``papers``, which the experiments need."""


@dataclass(frozen=True, slots=True)
class Experiment:
    """The experiments of one paper."""

    paper: str
    title: str
    module: str

    def run(self, figures: Path) -> list[Claim]:
        """Run the experiments, write their figures into a folder and return the claims with their results."""
        claims: list[Claim] = importlib.import_module(self.module).run(figures)
        return claims


def found() -> tuple[Experiment, ...]:
    """Return all experiments, sorted by paper.

    Raises
    ------
    InputError
        If a package of the extra ``papers`` is missing.
    """
    for package in EXTRA:
        if importlib.util.find_spec(package) is None:
            raise InputError(f"the papers' experiments need {package}: pip install -e '.[papers]'")
    rooms = [info.name for info in pkgutil.iter_modules(studies.papers.__path__) if info.ispkg]
    return tuple(sorted((_experiment(room) for room in rooms), key=lambda one: one.paper))


def chosen(papers: Sequence[str]) -> tuple[Experiment, ...]:
    """Return the experiments of the given papers; of all papers if none is given.

    Raises
    ------
    InputError
        If a paper has no experiments.
    """
    existing = found()
    known = {one.paper for one in existing}
    for paper in papers:
        if paper not in known:
            raise InputError(f"no paper {paper!r}; there are {', '.join(sorted(known)) or 'none'}")
    return tuple(one for one in existing if not papers or one.paper in papers)


def _experiment(room: str) -> Experiment:
    module = importlib.import_module(f"{studies.papers.__name__}.{room}.experiments")
    return Experiment(module.PAPER, module.TITLE, module.__name__)
