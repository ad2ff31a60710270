"""A cross-check of an estimated probability: near misses extrapolated to the event by extreme-value theory.

Peaks over a threshold, as surrogate-safety studies fit them to near misses [Songchitruksa2006]: the smallest
margins of passages that were drawn from the distributions follow a generalised Pareto distribution, and what
that has beyond a margin of 0 is the probability. It assumes that events continue the near misses, so it is no
estimate that anything may rest on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.arrays import FloatArray

SHARE = 0.1
"""Of the margins, the smallest ones, which are the peaks."""
FEWEST_PEAKS = 30
"""Without an event; fewer say nothing about a tail."""
RESAMPLES = 500
LEAST_SHAPE = -1.0
"""Below, the likelihood has no maximum."""
_LOGS = np.linspace(-8.0, 8.0, 400)
"""Of 1 + ξ·threshold / σ, none of them 0: a tail that ends does so beyond 0."""
_RATIOS = np.expm1(_LOGS)


@dataclass(frozen=True, slots=True)
class Extrapolated:
    """A probability by extrapolation."""

    probability: float
    low: float
    high: float
    """95 % interval by bootstrap over passages."""
    margins: int
    """Passages drawn from the distributions."""
    peaks: int
    """Of these, those in the tail."""
    shape: float
    """Of the generalised Pareto distribution; below 0 the tail ends."""


def extrapolated(margins: Sequence[float] | FloatArray, seed: int) -> Extrapolated | None:
    """Return what the tail of margins says of a margin below 0.

    Parameters
    ----------
    margins
        Of passages drawn from the distributions, from −1 to 1, as `analysis.search.objective` has them.
    seed
        Of the bootstrap.

    Returns
    -------
    Extrapolated or None
        ``None`` with fewer than `FEWEST_PEAKS` near misses, and where more than a tenth have the event.
    """
    found = np.asarray(margins, dtype=np.float64)
    distances = np.full(found.shape, np.inf)
    inside = np.abs(found) < 1.0
    distances[inside] = found[inside] / (1.0 - np.abs(found[inside]))
    distances[found <= -1.0] = -np.inf
    fitted = _tail(distances)
    if fitted is None:
        return None
    generator = np.random.default_rng(seed)
    again = [_tail(generator.choice(distances, distances.size)) for _ in range(RESAMPLES)]
    low, high = np.quantile([one[0] for one in again if one is not None], (0.025, 0.975))
    probability, peaks, shape = fitted
    return Extrapolated(probability, float(low), float(high), distances.size, peaks, shape)


def _tail(distances: FloatArray) -> tuple[float, int, float] | None:
    """Return the probability of a distance below 0, the number of peaks, and the shape of the tail."""
    if not distances.size:
        return None
    threshold = float(np.quantile(distances, SHARE, method="higher"))
    below = distances[distances < threshold]
    near = below[below > 0.0]
    if not np.isfinite(threshold) or threshold <= 0.0 or near.size < FEWEST_PEAKS:
        return None
    # Maximum likelihood in one dimension. With shape ξ, scale σ and s the log of 1 + ξ · threshold / σ, the
    # best ξ for an s is a mean. Of an event only that it is beyond 0 is used: its margin has another scale.
    of_near = np.log1p(_RATIOS[:, None] * (1.0 - near / threshold)).sum(axis=1)
    shapes = (of_near + (below.size - near.size) * _LOGS) / near.size
    likelihoods = near.size * np.log(_RATIOS / shapes) - of_near
    best = int(np.argmax(np.where(shapes > LEAST_SHAPE, likelihoods, -np.inf)))
    beyond = math.exp(-_LOGS[best] / shapes[best])
    return below.size / distances.size * beyond, int(below.size), float(shapes[best])
