"""The papers whose experiments exist: each room of this folder has a module ``experiments``.

It says which ``PAPER`` it is, its ``TITLE``, and has ``run``.
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
"""Packages of the extra ``papers``; the experiments need both."""


@dataclass(frozen=True, slots=True)
class Experiment:
    """The experiments of one paper."""

    paper: str
    title: str
    module: str

    def run(self, figures: Path) -> list[Claim]:
        """Run them, write their figures into a folder and return what became of the claims."""
        claims: list[Claim] = importlib.import_module(self.module).run(figures)
        return claims


def found() -> tuple[Experiment, ...]:
    """Return what there is, by paper.

    Raises
    ------
    InputError
        Where a package of the extra ``papers`` is missing.
    """
    for package in EXTRA:
        if importlib.util.find_spec(package) is None:
            raise InputError(f"the papers' experiments need {package}: pip install -e '.[papers]'")
    rooms = [info.name for info in pkgutil.iter_modules(studies.papers.__path__) if info.ispkg]
    return tuple(sorted((_experiment(room) for room in rooms), key=lambda one: one.paper))


def chosen(papers: Sequence[str]) -> tuple[Experiment, ...]:
    """Return those of some papers, all of them for none.

    Raises
    ------
    InputError
        For a paper that has none.
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
