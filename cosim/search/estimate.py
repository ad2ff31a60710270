"""Estimates how often an event would happen in a passage, given the declared distributions."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from scipy.special import ndtr

from analysis.errors import did_you_mean
from analysis.files import write_csv, write_json
from analysis.sealing import seal_tables
from analysis.search.axes import Value
from analysis.search.extremes import Extrapolated, extrapolated
from analysis.search.objective import judge_contacts
from analysis.search.probability import METHODS, MOST_REPLICATIONS, Probability, estimate
from analysis.search.results import PACKAGE
from analysis.tables import column
from analysis.tables.cells import cells
from analysis.tables.column import Table
from analysis.tables.datapackage import describe
from cosim.arrays import FloatArray
from cosim.batches.study import DEFAULT_TIMEOUT_S
from cosim.batches.worker import Handling
from cosim.errors import InputError, SimulationError
from cosim.processes import cores
from cosim.recording import folders
from cosim.search.folder import begin, check_folder, described
from cosim.search.proposals import missing
from cosim.search.search import TRIALS, Shown
from cosim.search.subject import Subject, read_subject
from cosim.search.trials import Answer, Trial, Trials, Where, makers, running

EVENTS = ("contact", "preventable-contact", "criteria")
SEEDS = 1000
"""Number of seeds to draw from; the seed decides the traffic and everything else that is random."""
FEWEST = 100
NOTHING = 1.0
"""Margin of a run that failed or had nothing to judge; positive, so that it does not count as an event."""


@dataclass(frozen=True, slots=True)
class EstimateRequest:
    """A user's request for a probability."""

    scenario: str
    controller: str = "vo_mpc"
    event: str = "contact"
    method: str = "importance"
    variation: float = 0.3
    budget: int = 5000
    seed: int = 1
    settings: Mapping[str, str] = field(default_factory=dict)
    space: Path | None = None
    criteria: Path | None = None
    out: Path | None = None
    jobs: int | None = None
    scheduler: str | None = None
    """Address of a Dask scheduler, whose workers make the runs."""
    run_timeout_s: float = DEFAULT_TIMEOUT_S

    @property
    def folder(self) -> Path:
        """Folder of the estimate."""
        name = f"estimate-{Path(self.scenario).stem}-{folders.plain(self.controller)}-{self.seed}"
        return folders.DEFAULT_PARENT / name if self.out is None else self.out

    @property
    def where(self) -> Where:
        """Where the runs are made."""
        return Where(self.jobs or cores(), self.scheduler)

    def command(self) -> str:
        """Return the command that continues an estimate that has ended."""
        words = ["cosim", "estimate", self.scenario, "--controller", self.controller, "--event", self.event]
        words += ["--method", self.method, "--variation", f"{self.variation:g}", "--budget", str(self.budget)]
        words += ["--seed", str(self.seed)]
        for key, text in self.settings.items():
            words += ["--set", f"{key}={text}"]
        for flag, value in (("--space", self.space), ("--criteria", self.criteria), ("--out", self.out)):
            words += [] if value is None else [flag, str(value)]
        words += [] if self.scheduler is None else ["--scheduler", self.scheduler]
        return shlex.join(words)


@dataclass(frozen=True, slots=True)
class Estimated:
    """Result of an estimate."""

    folder: Path
    probability: Probability
    invalid: int
    """Runs that failed; none of them counts as an event."""
    unpreventable: int
    """Runs with an event that nobody could have prevented."""
    check: Extrapolated | None
    """Cross-check extrapolated from near misses; ``None`` if these are too few, or the events too many."""


def prepared_estimate(request: EstimateRequest) -> tuple[Subject, str]:
    """Check everything that can be wrong; return the subject, and a text with all that determines its runs.

    Raises
    ------
    InputError
        If anything is wrong; one line with what was expected.
    """
    for option, value, known in (("--method", request.method, METHODS), ("--event", request.event, EVENTS)):
        if value not in known:
            hint = did_you_mean(value, known)
            raise InputError(f"{option} {value}: {hint}expected one of {', '.join(known)}")
    if not 0.0 < request.variation < 1.0:
        raise InputError(f"--variation: expected a number above 0 and below 1, got {request.variation:g}")
    if request.budget < FEWEST:
        raise InputError(f"--budget {request.budget}: expected at least {FEWEST} runs")
    if request.method == "importance" and find_spec("openturns") is None:
        raise missing("openturns")
    subject = read_subject(
        request.scenario, request.controller, request.settings, request.space, request.criteria
    )
    about = described(
        "What decides the runs of an estimate. Written by cosim estimate.",
        subject,
        {
            "event": request.event,
            "method": request.method,
            "variation": request.variation,
            "budget": request.budget,
            "seed": request.seed,
            "seeds": SEEDS,
        },
        request.settings,
    )
    folders.check_links(request.folder)
    check_folder(request.folder, about)
    return subject, about


def run_estimate(request: EstimateRequest, subject: Subject, about: str, shown: Shown) -> Estimated:
    """Make the runs, and write the estimate.

    Raises
    ------
    InputError
        If a run cannot be made, or the folder has runs of another estimate, code or version.
    SimulationError
        If every run of the first block failed.
    """
    folder = request.folder
    handling = Handling(request.run_timeout_s, drop_recordings=True)
    with makers(subject, folder / TRIALS, request.where, handling) as hands:
        begin(folder, about)
        with (
            shown as show,
            running(subject, folder / TRIALS, about, hands, request.budget, show) as trials,
        ):
            margins = Margins(subject, trials, request.event, request.seed)
            found = estimate(
                request.method,
                margins,
                margins.dimension,
                variation=request.variation,
                most=request.budget,
                seed=first_seed(request.seed),
            )
    invalid = sum(bool(one.invalid) for one in margins.answers)
    unpreventable = sum(one.verdict.unpreventable for one in margins.answers)
    done = Estimated(folder, found, invalid, unpreventable, extrapolated(found.drawn, request.seed))
    _write(request, done)
    return done


def first_seed(seed: int) -> int:
    """Return the seed of the first replication, so that estimates with neighbouring seeds share none.

    Examples
    --------
    >>> first_seed(1), first_seed(2)
    (1, 101)
    """
    return (1 + (seed - 1) * MOST_REPLICATIONS) % 2**32  # OpenTURNS takes 32 bits


class Margins:
    """Maps standard normal numbers to passages, runs each passage once, and returns the margins.

    Parameters
    ----------
    subject
    trials
        Makes the runs.
    event
        One of `EVENTS`.
    seed
        First of the seeds to draw from.
    """

    def __init__(self, subject: Subject, trials: Trials, event: str, seed: int) -> None:
        self._subject = subject
        self._trials = trials
        self._event = event
        self._seed = seed
        self._known: dict[tuple[tuple[str, Value], ...], float] = {}
        self.answers: list[Answer] = []
        self.dimension = len(subject.space.parameters) + 1

    def __call__(self, inputs: FloatArray) -> FloatArray:
        """Return the margins of the passages for rows of standard normal numbers."""
        points = [self._point(row) for row in ndtr(inputs).tolist()]
        new = [one for one in dict.fromkeys(points) if one not in self._known]
        answers = self._trials.run([self._trial(one, number) for number, one in enumerate(new, 1)])
        self.answers += answers
        if not self._known and answers and all(one.invalid for one in answers):
            raise SimulationError(
                f"every one of {len(answers)} runs failed, for instance: {answers[0].invalid}"
            )
        for point, answer in zip(new, answers, strict=True):
            self._known[point] = self._margin(answer)
        return np.array([self._known[one] for one in points])

    def _point(self, shares: Sequence[float]) -> tuple[tuple[str, Value], ...]:
        parameters = self._subject.space.parameters
        point: dict[str, Value] = {
            one.axis.name: one.quantile(share) for one, share in zip(parameters, shares[:-1], strict=True)
        }
        # Parameters that have no effect at this point must not make it a different passage.
        kept = {one.axis.name: point[one.axis.name] for one in parameters if one.axis.matters(point)}
        rest = {one.axis.name: one.axis.value(0.5) for one in parameters if one.axis.name not in kept}
        seed = self._seed + min(int(shares[-1] * SEEDS), SEEDS - 1)
        return (*sorted({**rest, **kept}.items()), (" seed", seed))

    def _trial(self, point: tuple[tuple[str, Value], ...], number: int) -> Trial:
        values = dict(point)
        seed = int(values.pop(" seed"))
        name = f"passage-{len(self.answers) + number:06d}"
        one = self._subject
        return Trial(name, values, seed, f"A passage of {one.controller} in {one.loaded.name}, drawn")

    def _margin(self, answer: Answer) -> float:
        if answer.invalid:
            return NOTHING
        if self._event == "criteria":
            return NOTHING if answer.verdict.margin is None else answer.verdict.margin
        rows = self._trials.encounters(answer.trial)
        return judge_contacts(rows, preventable_only=self._event == "preventable-contact")


ESTIMATE = Table(
    "estimate",
    "The probability of an event per passage",
    (
        column.text("scenario_id", "scenario", required=True),
        column.text("controller", "name of the controller", required=True),
        column.text("event", "what happens", *EVENTS, required=True),
        column.text("method", "how it was estimated", *METHODS, required=True),
        column.at_least_0("probability", "1", "of the event, per passage", required=True),
        column.at_least_0("ci95_lo", "1", "95 % interval, from", required=True),
        column.at_least_0("ci95_hi", "1", "to", required=True),
        column.at_least_0("variation", "1", "coefficient of variation of the estimate"),
        column.flag("reached", "whether the wanted coefficient of variation was reached", required=True),
        column.count("n_runs", "margins that were asked for", required=True),
        column.count("n_events", "of these with the event", required=True),
        column.count("n_replications", "independent estimates that the interval is from", required=True),
        column.count("n_dropped", "independent estimates that led nowhere and are left out"),
        column.count("n_invalid", "runs that failed, counted as no event", required=True),
        column.count("n_unpreventable", "runs with what nobody could have prevented", required=True),
        column.count("seed", "first seed", required=True),
        column.at_least_0("extrapolated", "1", "cross-check: probability extrapolated from near misses"),
        column.at_least_0("extrapolated_ci95_lo", "1", "95 % interval of the cross-check, from"),
        column.at_least_0("extrapolated_ci95_hi", "1", "to"),
        column.count("n_drawn", "runs drawn from the distributions, of which the cross-check is made"),
        column.count("n_peaks", "of these, the ones with the smallest margins, to which a tail is fitted"),
    ),
    ("scenario_id", "controller", "event", "method"),
)


def _write(request: EstimateRequest, done: Estimated) -> None:
    folder, found, check = done.folder, done.probability, done.check
    row = {
        "scenario_id": request.scenario,
        "controller": request.controller,
        "event": request.event,
        "method": found.method,
        "probability": found.estimate,
        "ci95_lo": found.low,
        "ci95_hi": found.high,
        "variation": found.variation,
        "reached": found.reached,
        "n_runs": found.runs,
        "n_events": found.events,
        "n_replications": found.replications,
        "n_dropped": found.dropped,
        "n_invalid": done.invalid,
        "n_unpreventable": done.unpreventable,
        "seed": request.seed,
        "extrapolated": None if check is None else check.probability,
        "extrapolated_ci95_lo": None if check is None else check.low,
        "extrapolated_ci95_hi": None if check is None else check.high,
        "n_drawn": len(found.drawn),
        "n_peaks": None if check is None else check.peaks,
    }
    table = write_csv(
        folder / ESTIMATE.file, ESTIMATE.names(), cells(ESTIMATE, [row], number="{:.6g}".format)
    )
    seal_tables(folder, [table, write_json(folder / PACKAGE, describe([ESTIMATE], "an estimate"))])
