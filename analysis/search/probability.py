"""Probability of an event: crude Monte Carlo, subset simulation, and importance sampling by OpenTURNS.

The inputs are independent standard normal numbers; the event is a margin below 0. The last two methods need
a margin that says how near the event is. Their own intervals rest on approximations, so each is run several
times with other random numbers, and the interval comes from the scatter of these replications. An estimate
is a product over levels, so that the replications scatter by factors, nearly lognormally.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.stats import t as student

from analysis.arrays import FloatArray
from analysis.search.subset import subset_simulation
from analysis.statistics.intervals import share_interval

METHODS = ("crude", "subset", "importance")
BLOCK = 100
"""Number of margins computed at a time."""
BLOCKS_OF_LEVEL = 4
"""Number of blocks in each level of a replication."""
LEVEL = 0.1
"""Conditional probability of each level."""
FEWEST_REPLICATIONS = 4
MOST_REPLICATIONS = 100
MOST_USELESS, NEARER = 6, 0.95
"""A replication is given up after this many levels in a row in which no threshold was below this share of
the lowest one before."""

Evaluate = Callable[[FloatArray], FloatArray]
"""Maps standard normal numbers, an array (n, dimension), to margins, an array (n)."""


@dataclass(frozen=True, slots=True)
class Probability:
    """An estimate."""

    method: str
    estimate: float
    low: float
    high: float
    """95 % interval."""
    variation: float | None
    """Coefficient of variation of the estimate; ``None`` while it is 0."""
    runs: int
    """Number of margins computed."""
    events: int
    """Number of margins below 0."""
    replications: int
    reached: bool
    """Whether the desired coefficient of variation was reached."""
    dropped: int = 0
    """Number of replications without an estimate: they came no nearer to the event, or ran out of runs."""
    drawn: tuple[float, ...] = field(default=(), repr=False)
    """Margins of inputs drawn from their own distribution, before a method moved towards the event."""


class _GivenUp(Exception):
    """A replication gets no nearer to the event, or the runs are used up."""


class _Counting:
    """Evaluates and counts margins, and keeps an error that OpenTURNS would replace by one of its own."""

    def __init__(self, evaluate: Evaluate, most: int) -> None:
        self._evaluate = evaluate
        self._most = most
        self.runs = 0
        self.events = 0
        self.drawn: list[float] = []
        self.error: BaseException | None = None

    def begin(self, level: int) -> None:
        """Begin a replication with ``level`` inputs per level, the first from their own distribution."""
        self._to_draw = self._level_size = level
        self._end = self.runs + self._most
        self._level: list[float] = []
        self._nearest, self._useless = math.inf, 0

    def __call__(self, inputs: Any) -> FloatArray:
        if self.runs >= self._end or self._useless >= MOST_USELESS:
            raise _GivenUp
        try:
            margins = np.asarray(self._evaluate(np.asarray(inputs, dtype=np.float64)), dtype=np.float64)
        except BaseException as error:
            self.error = error
            raise
        self.drawn += margins[: self._to_draw].tolist()
        self._to_draw -= min(self._to_draw, len(margins))
        self.runs += len(margins)
        self.events += int(np.count_nonzero(margins < 0.0))
        self._watch(margins)
        return margins

    def _watch(self, margins: FloatArray) -> None:
        """Count the levels that come no nearer to the event.

        If the margin jumps from well above 0 to below it, a method moves to the inputs that just miss, and
        would draw there for ever.
        """
        self._level += margins.tolist()
        if len(self._level) < self._level_size:
            return
        threshold = float(np.quantile(self._level, LEVEL))
        self._useless = 0 if threshold < NEARER * self._nearest else self._useless + 1
        self._nearest, self._level = min(self._nearest, threshold), []


def estimate(
    method: str, evaluate: Evaluate, dimension: int, *, variation: float, most: int, seed: int
) -> Probability:
    """Estimate a probability until its coefficient of variation is small enough.

    Parameters
    ----------
    method
        One of `METHODS`.
    evaluate
    dimension
        Number of inputs.
    variation
        Desired coefficient of variation.
    most
        Number of margins to compute; a replication that has begun is finished, unless it alone needs twice
        as many.
    seed
        Of the first replication; each further one has the next number. Estimates that are to be independent
        begin at least `MOST_REPLICATIONS` apart.

    Raises
    ------
    ModuleNotFoundError
        If OpenTURNS is missing, for importance sampling.
    """
    counting = _Counting(evaluate, 2 * most)
    if method == "crude":
        return _crude(counting, dimension, variation, most, seed)
    return _replicated(method, counting, dimension, variation, most, seed)


def _crude(counting: _Counting, dimension: int, variation: float, most: int, seed: int) -> Probability:
    """Draw until there are enough events; the interval is the exact interval of Clopper and Pearson."""
    generator = np.random.default_rng(seed)
    counting.begin(most)
    reached = False
    while counting.runs < most and not reached:
        counting(generator.standard_normal((min(BLOCK, most - counting.runs), dimension)))
        found = _variation_of_share(counting.events, counting.runs)
        reached = found is not None and found <= variation
    interval = share_interval(counting.events, counting.runs)
    assert interval is not None
    return Probability(
        "crude",
        counting.events / counting.runs,
        interval.low,
        interval.high,
        _variation_of_share(counting.events, counting.runs),
        counting.runs,
        counting.events,
        1,
        reached,
        drawn=tuple(counting.drawn),
    )


def _variation_of_share(events: int, trials: int) -> float | None:
    share = events / trials
    return math.sqrt((1.0 - share) / (share * trials)) if events else None


def _replicated(
    method: str, counting: _Counting, dimension: int, variation: float, most: int, seed: int
) -> Probability:
    found: list[float] = []
    attempts = 0
    reached = False
    while attempts < MOST_REPLICATIONS and not reached:
        if len(found) >= FEWEST_REPLICATIONS and counting.runs * (1.0 + 1.0 / attempts) > most:
            break
        value = _replication(method, counting, dimension, seed + attempts)
        attempts += 1
        if value is not None:
            found.append(value)
        scatter = _variation_of_mean(found)
        reached = len(found) >= FEWEST_REPLICATIONS and scatter is not None and scatter <= variation
        if counting.runs > most and (len(found) >= 2 or len(found) < attempts):
            break
    mean = float(np.mean(found)) if found else 0.0
    scatter = _variation_of_mean(found)
    low, high = _interval(found)
    return Probability(
        method,
        mean,
        low,
        high,
        scatter,
        counting.runs,
        counting.events,
        len(found),
        reached,
        attempts - len(found),
        tuple(counting.drawn),
    )


def _variation_of_mean(values: list[float]) -> float | None:
    if len(values) < 2 or not any(values):
        return None
    return float(np.std(values, ddof=1) / np.mean(values) / math.sqrt(len(values)))


def _interval(values: list[float]) -> tuple[float, float]:
    """Return the 95 % interval of the mean of positive numbers that scatter by factors.

    This is Cox's interval of a lognormal mean with Student's t [Olsson2005]. An interval from the scatter of
    the mean would lack its second term: few numbers of a skewed distribution often miss the rare large ones,
    and then both mean and scatter are too small.
    """
    count = len(values)
    if count < 2:
        return 0.0, 1.0
    mean, variance = float(np.mean(values)), float(np.var(np.log(values), ddof=1))
    deviation = math.sqrt(variance / count + variance**2 / (2.0 * (count - 1)))
    wide = float(student.ppf(0.975, count - 1)) * deviation
    return mean * math.exp(-wide), min(1.0, mean * math.exp(wide))


def _replication(method: str, counting: _Counting, dimension: int, seed: int) -> float | None:
    """Return one estimate, above 0; ``None`` if the method finds none."""
    counting.begin(BLOCK * BLOCKS_OF_LEVEL)  # both begin with a level of crude sampling
    try:
        if method == "importance":
            return _importance(counting, dimension, seed) or None
        level = BLOCK * BLOCKS_OF_LEVEL
        return subset_simulation(counting, dimension, level=level, share=LEVEL, seed=seed) or None
    except _GivenUp:
        return None


def _importance(counting: _Counting, dimension: int, seed: int) -> float:
    """Return an estimate; 0 if there is no event.

    Raises
    ------
    _GivenUp
    """
    import openturns as ot

    ot.RandomGenerator.SetSeed(seed)
    function = ot.PythonFunction(
        dimension, 1, func_sample=lambda inputs: counting(inputs).reshape(-1, 1).tolist()
    )
    inputs = ot.RandomVector(ot.Normal(dimension))
    event = ot.ThresholdEvent(ot.CompositeRandomVector(function, inputs), ot.Less(), 0.0)
    algorithm = ot.NAIS(event, LEVEL)
    algorithm.setBlockSize(BLOCK)
    algorithm.setMaximumOuterSampling(BLOCKS_OF_LEVEL)
    before = counting.events
    try:
        algorithm.run()
    except (TypeError, RuntimeError):
        if counting.error is not None:
            raise counting.error from None
        raise _GivenUp from None  # the count stopped it, or its own estimate of the variance was below 0
    return float(algorithm.getResult().getProbabilityEstimate()) if counting.events > before else 0.0


_UNITS = (
    (1e2, "a hundred"),
    (1e3, "a thousand"),
    (1e4, "ten thousand"),
    (1e5, "a hundred thousand"),
    (1e6, "a million"),
    (1e7, "ten million"),
    (1e8, "a hundred million"),
    (1e9, "a thousand million"),
)


def in_words(low: float, high: float) -> str:
    """Return an interval in words, as numbers of passages.

    Examples
    --------
    >>> in_words(2.2e-6, 8.7e-6)
    'between 2 and 9 in a million'
    >>> in_words(0.011, 0.034)
    'between 11 and 34 in a thousand'
    >>> in_words(0.0, 0.0004)
    'at most 40 in a hundred thousand'
    """
    fitting = [number for number, _ in _UNITS if (high - low) * number >= 5.0]
    unit = min(fitting, default=_UNITS[-1][0])
    name = dict(_UNITS)[unit]
    at_most = math.ceil(high * unit - 1e-9)
    if low <= 0.0:
        return f"at most {at_most} in {name}"
    return f"between {math.floor(low * unit + 1e-9)} and {at_most} in {name}"
