"""Proposes points in generations of a fixed size; the same answers lead to the same proposals."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from scipy.stats import qmc

from analysis.errors import did_you_mean
from analysis.search.axes import Axis, Point, Value, distance, point
from cosim.errors import InputError

METHODS = ("cma-es", "tpe", "sobol", "random", "nsga-ii")
GENERATION = 10
"""Number of points that are proposed at a time; it does not depend on the number of worker processes."""
EVEN_SHARE = 0.25
"""Share of the budget that covers the space evenly before a learning method begins."""
MOST_EVEN = 60
ROUND = 6
"""Largest number of generations from one starting point of CMA-ES."""
STALL = 3
"""Number of generations without a smaller margin after which a round ends."""
ALWAYS_EVEN = 0.2
"""Share of every generation that covers the space evenly, regardless of what was learnt."""
STEP = 0.12
"""Initial step size of a round, as a share of an axis."""
NEW = 0.2
"""The starting points of rounds are farther apart than this, as a share of the axes, if possible."""
NEUTRAL = 1.0
"""Margin that is assumed for a trial without a margin."""


class Proposer(Protocol):
    """Proposes points and is told their margins."""

    def ask(self, count: int) -> list[dict[str, Value]]:
        """Return that many points."""
        ...

    def tell(self, points: Sequence[Point], margins: Sequence[float]) -> None:
        """Learn the margins of the points last asked for."""
        ...


def first_generations(method: str, budget: int) -> int:
    """Return how many trials are proposed before the method has learnt anything."""
    if method in ("sobol", "random", "nsga-ii"):
        return GENERATION
    wanted = min(max(budget * EVEN_SHARE, GENERATION), MOST_EVEN)
    return GENERATION * round(wanted / GENERATION)


def propose(method: str, axes: Sequence[Axis], seed: int, budget: int) -> Proposer:
    """Return a proposer.

    Raises
    ------
    InputError
        If the method is unknown.
    """
    if method not in METHODS:
        hint = did_you_mean(method, METHODS)
        raise InputError(f"--method {method}: {hint}expected one of {', '.join(METHODS)}")
    if method == "random":
        return _Random(axes, seed)
    if method == "sobol":
        return _Even(axes, seed)
    even = _Even(axes, seed)
    if method == "nsga-ii":
        return _Sampled(axes, seed, None, method)
    count = first_generations(method, budget)
    numeric = sum(axis.numeric for axis in axes)
    if method == "cma-es" and numeric > 1:
        return _Rounds(axes, seed, even, count)
    return _Sampled(axes, seed, (even, count), "tpe")


class _Random:
    def __init__(self, axes: Sequence[Axis], seed: int) -> None:
        self._axes, self._generator = axes, np.random.default_rng(seed)

    def ask(self, count: int) -> list[dict[str, Value]]:
        return [point(self._axes, self._generator.random(len(self._axes)).tolist()) for _ in range(count)]

    def tell(self, points: Sequence[Point], margins: Sequence[float]) -> None:
        pass


class _Even(_Random):
    """Sobol's sequence, scrambled by the seed."""

    def __init__(self, axes: Sequence[Axis], seed: int) -> None:
        super().__init__(axes, seed)
        self._sequence = qmc.Sobol(len(axes), rng=np.random.default_rng(seed))

    def ask(self, count: int) -> list[dict[str, Value]]:
        with warnings.catch_warnings():
            # SciPy warns that numbers of points other than powers of 2 are a little less even.
            warnings.simplefilter("ignore", UserWarning)
            drawn = self._sequence.random(count)
        return [point(self._axes, row) for row in drawn.tolist()]


class _Sampled:
    """Optuna's sampler over all axes, after points that cover the space evenly."""

    def __init__(self, axes: Sequence[Axis], seed: int, even: tuple[_Even, int] | None, method: str) -> None:
        optuna = _optuna()
        self._axes = axes
        self._even = even
        self._told = 0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # multivariate TPE calls itself experimental
            if method == "tpe":
                sampler = optuna.samplers.TPESampler(
                    seed=seed, multivariate=True, n_startup_trials=0, constant_liar=True
                )
            else:
                sampler = optuna.samplers.NSGAIISampler(seed=seed, population_size=2 * GENERATION)
            self._study = optuna.create_study(sampler=sampler)
        self._space = {axis.name: _distribution(axis) for axis in axes}
        self._waiting: list[Any] = []

    def ask(self, count: int) -> list[dict[str, Value]]:
        self._waiting = []
        if self._even is not None and self._told < self._even[1]:
            return self._even[0].ask(count)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self._waiting = [self._study.ask(self._space) for _ in range(count)]
        return [_of_trial(self._axes, trial.params) for trial in self._waiting]

    def tell(self, points: Sequence[Point], margins: Sequence[float]) -> None:
        self._told += len(points)
        if self._waiting:
            for trial, margin in zip(self._waiting, margins, strict=True):
                self._study.tell(trial, margin)
            return
        optuna = _optuna()
        for one, margin in zip(points, margins, strict=True):
            params = _as_params(self._axes, one)
            self._study.add_trial(
                optuna.trial.create_trial(params=params, distributions=self._space, value=margin)
            )


class _Rounds:
    """Rounds of CMA-ES over the numbers, each from a promising point and with the choices of that point.

    A round begins at the point with the smallest margin among those far from all earlier starting points:
    a bandit over regions and choices. A round ends after `ROUND` generations, after `STALL` generations
    without a smaller margin, or once a whole generation has failed, so that one kind of failure does not
    use up the budget. Small margins need not lead to a failure. Therefore, a share of every generation
    covers the space evenly, and a round without any failure is followed by the same number of generations
    that only do that.
    """

    def __init__(self, axes: Sequence[Axis], seed: int, even: _Even, count: int) -> None:
        self._axes = axes
        self._seed = seed
        self._even = even
        self._numeric = [axis for axis in axes if axis.numeric]
        self._known: list[tuple[Point, float]] = []
        self._starts: list[Point] = []
        self._study: Any = None
        self._margins: list[float] = []
        """Smallest margin of each generation of the round."""
        self._evenly = count // GENERATION
        """Number of generations still to come that only cover the space evenly."""
        self._waiting: list[Any] = []
        self._space = {axis.name: _share_distribution() for axis in self._numeric}

    def ask(self, count: int) -> list[dict[str, Value]]:
        self._waiting = []
        if self._evenly:
            return self._even.ask(count)
        if not self._margins:
            self._begin_round()
        start = self._starts[-1]
        evenly = int(count * ALWAYS_EVEN)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self._waiting = [self._study.ask(self._space) for _ in range(count - evenly)]
        return [
            {
                axis.name: axis.value(trial.params[axis.name]) if axis.numeric else start[axis.name]
                for axis in self._axes
            }
            for trial in self._waiting
        ] + self._even.ask(evenly)

    def tell(self, points: Sequence[Point], margins: Sequence[float]) -> None:
        self._known += zip(points, margins, strict=True)
        if not self._waiting:
            self._evenly -= 1
            return
        own = list(margins[: len(self._waiting)])
        for trial, margin in zip(self._waiting, own, strict=True):
            self._study.tell(trial, margin)
        self._margins.append(min(own))
        generations = len(self._margins)
        stalled = min(self._margins[-STALL:]) >= min(self._margins[:-STALL], default=math.inf)
        if generations == ROUND or stalled or max(own) < 0.0:
            self._evenly = 0 if min(self._margins) < 0.0 else generations
            self._margins = []

    def _begin_round(self) -> None:
        optuna = _optuna()
        new = [
            one
            for one in self._known
            if all(distance(self._axes, one[0], start) > NEW for start in self._starts)
        ]
        start = min(new or self._known, key=lambda one: one[1])[0]
        self._starts.append(start)
        number = len(self._starts)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sampler = optuna.samplers.CmaEsSampler(
                x0={axis.name: axis.share(start[axis.name]) for axis in self._numeric},
                sigma0=STEP,
                seed=self._seed + 7919 * number,
                popsize=GENERATION - int(GENERATION * ALWAYS_EVEN),
                n_startup_trials=0,
                warn_independent_sampling=False,
            )
            self._study = optuna.create_study(sampler=sampler)
        # Add one trial, so that the sampler knows the axes; the trials of the round follow it.
        self._study.add_trial(
            optuna.trial.create_trial(
                params={axis.name: axis.share(start[axis.name]) for axis in self._numeric},
                distributions=self._space,
                value=NEUTRAL,
            )
        )


def missing(package: str) -> InputError:
    """Return an error that says which extra to install."""
    return InputError(f"{package} is not installed; run: pip install optuna cmaes SALib openturns")


def _optuna() -> Any:
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return optuna


def _share_distribution() -> Any:
    return _optuna().distributions.FloatDistribution(0.0, 1.0)


def _distribution(axis: Axis) -> Any:
    if axis.numeric:
        return _share_distribution()
    return _optuna().distributions.CategoricalDistribution(axis.choices)


def _as_params(axes: Sequence[Axis], one: Point) -> dict[str, Value]:
    return {axis.name: axis.share(one[axis.name]) if axis.numeric else one[axis.name] for axis in axes}


def _of_trial(axes: Sequence[Axis], params: Point) -> dict[str, Value]:
    return {
        axis.name: axis.value(float(params[axis.name])) if axis.numeric else params[axis.name]
        for axis in axes
    }
