"""A cross-check of an estimated probability: near misses extrapolated to the event by extreme-value theory.

Peaks over a threshold, as surrogate-safety studies fit them to near misses [Songchitruksa2006]: the smallest
margins of passages that were drawn from the distributions follow a generalised Pareto distribution, and what
that has beyond a margin of 0 is the probability. It assumes that events continue the near misses, so it is no
estimate that anything may rest on.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.arrays import FloatArray, IntArray

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
    order = np.argsort(distances)
    tails = _Tails(distances[order])
    fitted = tails.fitted([np.ones(distances.size, dtype=np.int64)])
    if not fitted:
        return None
    generator, size = np.random.default_rng(seed), distances.size
    resamples = (np.bincount(generator.integers(size, size=size), minlength=size) for _ in range(RESAMPLES))
    again = tails.fitted(counts[order] for counts in resamples)
    low, high = np.quantile([probability for probability, _, _ in again], (0.025, 0.975))
    probability, peaks, shape = fitted[0]
    return Extrapolated(probability, float(low), float(high), size, peaks, shape)


@dataclass(frozen=True, slots=True)
class _Tails:
    """Tails of samples of the same distances, in each of which a distance may be there several times."""

    distances: FloatArray
    """In their order, shape (n,)."""

    def fitted(self, samples: Iterable[IntArray]) -> list[tuple[float, int, float]]:
        """Return the probability of a distance below 0, the number of peaks, and the shape of each tail.

        Samples, given as how often each distance is in them, that have no tail are left out.
        """
        size = len(self.distances)
        if not size:
            return []
        rank = math.ceil((size - 1) * SHARE)
        # Few distances are the threshold of all samples, and what depends on it alone is computed once.
        by_threshold: dict[int, list[IntArray]] = {}
        for counts in samples:
            at = int(np.searchsorted(np.cumsum(counts), rank, side="right"))
            by_threshold.setdefault(at, []).append(counts[:at].copy())
        return [one for at, counts in by_threshold.items() for one in self._beyond(at, np.array(counts))]

    def _beyond(self, at: int, counts: IntArray) -> Iterator[tuple[float, int, float]]:
        """Yield the tails of samples with the same threshold, given what is nearer, shape (samples, at)."""
        threshold = float(self.distances[at])
        if not np.isfinite(threshold) or threshold <= 0.0:
            return
        first = int(np.searchsorted(self.distances, 0.0, side="right"))
        end = int(np.searchsorted(self.distances, threshold))
        # Maximum likelihood in one dimension. With shape ξ, scale σ and s the log of 1 + ξ · threshold / σ,
        # the best ξ for an s is a mean. Of an event only that it is beyond 0 is used: its margin has another
        # scale.
        logs = np.log1p(_RATIOS[:, None] * (1.0 - self.distances[first:end] / threshold))
        # Not by BLAS, whose sums depend on the machine.
        of_near = np.einsum("rn,kn->kr", logs, counts[:, first:end].astype(np.float64))
        belows, nears = (counts[:, at:end].sum(axis=1).tolist() for at in (0, first))
        for below, near, sums in zip(belows, nears, of_near, strict=True):
            if near < FEWEST_PEAKS:
                continue
            shapes = (sums + (below - near) * _LOGS) / near
            likelihoods = near * np.log(_RATIOS / shapes) - sums
            best = int(np.argmax(np.where(shapes > LEAST_SHAPE, likelihoods, -np.inf)))
            beyond = math.exp(-_LOGS[best] / shapes[best])
            yield below / len(self.distances) * beyond, below, float(shapes[best])
