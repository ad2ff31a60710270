"""Runs a search from its request to its results: generation after generation, then the kinds of failures."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from time import monotonic

from analysis.search.axes import Axis, Point
from analysis.search.kinds import kinds
from analysis.search.objective import Verdict
from analysis.search.results import FAIL, INVALID, KindRow, Tried, trial_margins, write_results
from analysis.search.sensitivity import Influence, influences
from cosim.batches.conduct import Tally
from cosim.batches.study import DEFAULT_TIMEOUT_S
from cosim.batches.worker import Handling
from cosim.errors import InputError, SimulationError
from cosim.processes import cores
from cosim.recording import folders
from cosim.search import regression, shrinking
from cosim.search.folder import begin, check_folder, described
from cosim.search.proposals import GENERATION, NEUTRAL, Proposer, first_generations, missing, propose
from cosim.search.subject import Subject, read_subject
from cosim.search.trials import Trial, Trials, Where, makers, running

TRIALS = "trials"
NEEDED = ("optuna", "cmaes", "SALib")
"""Extra packages that a search needs."""
SEED_AXIS = "seed"

Shown = AbstractContextManager[Callable[[Tally], None]]


@dataclass(frozen=True, slots=True)
class FalsifyRequest:
    """A user's request for a search."""

    scenario: str
    controller: str = "vo_mpc"
    budget: int = 200
    method: str = "cma-es"
    seed: int = 1
    settings: Mapping[str, str] = field(default_factory=dict)
    space: Path | None = None
    criteria: Path | None = None
    out: Path | None = None
    jobs: int | None = None
    scheduler: str | None = None
    """Address of a Dask scheduler, whose workers make the runs."""
    time_budget_s: float | None = None
    stop_at_first: bool = False
    shrink: bool = True
    run_timeout_s: float = DEFAULT_TIMEOUT_S

    @property
    def folder(self) -> Path:
        """Folder of the search."""
        name = f"falsify-{Path(self.scenario).stem}-{folders.plain(self.controller)}-{self.seed}"
        return folders.DEFAULT_PARENT / name if self.out is None else self.out

    @property
    def where(self) -> Where:
        """Where the runs are made."""
        return Where(self.jobs or cores(), self.scheduler)


@dataclass(frozen=True, slots=True)
class Found:
    """Result of a search."""

    folder: Path
    axes: tuple[Axis, ...]
    tried: tuple[Tried, ...]
    kinds: tuple[KindRow, ...]
    influences: tuple[Influence, ...]
    stopped: str = ""
    """Why the search ended before its budget was used up; empty if it did not."""


@dataclass(frozen=True, slots=True)
class Search:
    """A search whose parts have all been checked, ready to be run."""

    request: FalsifyRequest
    subject: Subject
    axes: tuple[Axis, ...]
    seeds: tuple[int, ...]
    about: str

    def run(self, shown: Shown) -> Found:
        """Make the missing trials, and write the results.

        Raises
        ------
        InputError
            If a trial cannot be run, or the folder has runs of another search, code or version.
        SimulationError
            If no trial has a result, or no further run can be made.
        """
        request, folder = self.request, self.request.folder
        handling = Handling(request.run_timeout_s, drop_recordings=True)
        runs = request.budget * (len(self.seeds) if self._averaged else 1)
        with makers(self.subject, folder / TRIALS, request.where, handling) as hands:
            begin(folder, self.about)
            with (
                shown as show,
                running(self.subject, folder / TRIALS, self.about, hands, runs, show) as trials,
            ):
                tried, stopped = self._search(trials)
                found = kinds(self.axes, [one.failure for one in tried if one.status == FAIL])
                changes = {}
                if request.shrink:
                    changes = shrinking.changes(self._space_axes, found, tried, trials, self.seedless)
        rows = regression.write_suite(self.subject, folder, found, self.seedless, changes)
        learnt = request.method not in ("sobol", "random")
        most = first_generations(request.method, request.budget) if learnt else request.budget
        influence = influences(self.axes, *trial_margins(one for one in tried if one.number <= most))
        write_results(folder, self.axes, tried, rows, influence)
        return Found(
            folder,
            self.axes,
            tuple(tried),
            tuple(rows),
            tuple(influence),
            stopped,
        )

    @property
    def _averaged(self) -> bool:
        return self.subject.space.table.seed == "averaged"

    @property
    def _space_axes(self) -> tuple[Axis, ...]:
        return tuple(axis for axis in self.axes if axis.name != SEED_AXIS)

    def seedless(self, point: Point) -> Point:
        """Return a point without its seed, as scenario files have none."""
        return {key: value for key, value in point.items() if key != SEED_AXIS}

    def _search(self, trials: Trials) -> tuple[list[Tried], str]:
        request = self.request
        proposer = propose(request.method, self.axes, request.seed, request.budget)
        started = monotonic()
        tried: list[Tried] = []
        number = 0
        while number < request.budget:
            count = min(GENERATION, request.budget - number)
            tried += self._generation(trials, proposer, number, count)
            number += count
            if number == GENERATION or number == request.budget:
                _check_answers(tried)
            if request.stop_at_first and any(one.status == FAIL for one in tried):
                return tried, "the first failure was found"
            if (
                request.time_budget_s is not None
                and number < request.budget
                and monotonic() - started >= request.time_budget_s
            ):
                return tried, f"the time budget of {request.time_budget_s:g} s was used up"
        return tried, ""

    def _generation(self, trials: Trials, proposer: Proposer, before: int, count: int) -> list[Tried]:
        points = proposer.ask(count)
        asked = [
            (number, point, seed)
            for number, point in enumerate(points, before + 1)
            for seed in (self.seeds if self._averaged else (int(point.get(SEED_AXIS, self.seeds[0])),))
        ]
        answers = trials.run(
            [
                Trial(f"trial-{number:04d}", self.seedless(point), seed, self._description(number))
                for number, point, seed in asked
            ]
        )
        margins: dict[int, list[float]] = {}
        for (number, _, _), answer in zip(asked, answers, strict=True):
            margins.setdefault(number, []).append(_margin(answer.verdict))
        means = {number: sum(some) / len(some) for number, some in margins.items()}
        proposer.tell(points, [means[number] for number in sorted(means)])
        return [
            Tried(
                number,
                seed,
                point,
                answer.verdict,
                answer.invalid,
                means[number] if self._averaged else None,
            )
            for (number, point, seed), answer in zip(asked, answers, strict=True)
        ]

    def _description(self, number: int) -> str:
        one = self.request
        return f"Trial {number} of a search for failures of {one.controller} in {self.subject.loaded.name}"


def _margin(verdict: Verdict) -> float:
    return NEUTRAL if verdict.margin is None else verdict.margin


def prepared(request: FalsifyRequest) -> Search:
    """Check everything that can be wrong with a search; nothing is written yet.

    Raises
    ------
    InputError
        If anything is wrong; one line with what was expected.
    """
    for name in NEEDED:
        if find_spec(name) is None:
            raise missing(name)
    subject = read_subject(
        request.scenario, request.controller, request.settings, request.space, request.criteria
    )
    table = subject.space.table
    seeds = tuple(range(request.seed, request.seed + (1 if table.seed == "fixed" else table.seeds)))
    axes = subject.space.axes
    if table.seed == "searched":
        axes = (*axes, Axis(SEED_AXIS, choices=tuple(map(str, seeds))))
    if not axes:
        raise InputError(f"{subject.space.place}: nothing to vary; expected [search.parameters.NAME]")
    propose(request.method, axes, request.seed, request.budget)
    least = first_generations(request.method, request.budget)
    if request.budget < GENERATION:
        raise InputError(
            f"--budget {request.budget}: expected at least {GENERATION} trials, the first generation"
        )
    assert least <= request.budget
    folder = request.folder
    folders.check_links(folder)
    about = described(
        "A search for failures: what decides its trials. Written by cosim falsify.",
        subject,
        {
            "budget": request.budget,
            "method": request.method,
            "seed": request.seed,
            "role_of_seeds": table.seed,
            "seeds": list(seeds),
            "generation": GENERATION,
        },
        request.settings,
    )
    check_folder(folder, about)
    return Search(request, subject, axes, seeds, about)


def _check_answers(tried: Sequence[Tried]) -> None:
    """Stop a search in which no trial has a result."""
    if all(one.status == INVALID for one in tried):
        raise SimulationError(f"every one of {len(tried)} runs failed, for instance: {tried[0].invalid}")
    if all(one.verdict.margin is None for one in tried):
        raise SimulationError(
            f"no criterion had anything to judge in any of {len(tried)} runs; expected a criterion that is "
            "defined for single runs, and egos that meet somebody"
        )


def command(request: FalsifyRequest) -> str:
    """Return the command that continues a search that has ended."""
    words = ["cosim", "falsify", request.scenario, "--controller", request.controller]
    words += ["--budget", str(request.budget), "--method", request.method, "--seed", str(request.seed)]
    for key, text in request.settings.items():
        words += ["--set", f"{key}={text}"]
    for flag, value in (("--space", request.space), ("--criteria", request.criteria), ("--out", request.out)):
        words += [] if value is None else [flag, str(value)]
    if request.stop_at_first:
        words.append("--stop-at-first")
    if not request.shrink:
        words.append("--no-shrink")
    if request.scheduler is not None:
        words += ["--scheduler", request.scheduler]
    return shlex.join(words)


@contextmanager
def silent() -> Iterator[Callable[[Tally], None]]:
    """Show nothing."""
    yield lambda tally: None
