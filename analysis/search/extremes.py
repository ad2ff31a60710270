"""A cross-check of an estimated probability: near misses extrapolated to the event by extreme-value theory.

The method is peaks over a threshold, as surrogate-safety studies apply it to near misses [Songchitruksa2006].
A generalised Pareto distribution is fitted to the smallest margins of passages drawn from the distributions;
its share beyond a margin of 0 is the probability. The method assumes that events continue the near misses, so
no conclusion may rest on its estimate.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.arrays import FloatArray, IntArray

SHARE = 0.1
"""Share of the margins that are peaks, the smallest ones."""
FEWEST_PEAKS = 30
"""Least number of peaks without an event; fewer say nothing about a tail."""
RESAMPLES = 500
LEAST_SHAPE = -1.0
"""Below this shape, the likelihood has no maximum."""
_LOGS = np.linspace(-8.0, 8.0, 400)
"""Logarithms of 1 + ξ·threshold / σ to try, none of them 0: a tail that ends does so beyond 0."""
_RATIOS = np.expm1(_LOGS)


@dataclass(frozen=True, slots=True)
class Extrapolated:
    """A probability estimated by extrapolation."""

    probability: float
    low: float
    high: float
    """95 % interval by bootstrap over passages."""
    margins: int
    """Number of passages drawn from the distributions."""
    peaks: int
    """Number of these that are in the tail."""
    shape: float
    """Shape of the generalised Pareto distribution; below 0, the tail ends."""


def extrapolated(margins: Sequence[float] | FloatArray, seed: int) -> Extrapolated | None:
    """Return the probability of a margin below 0, extrapolated from the tail of the margins.

    Parameters
    ----------
    margins
        Margins of passages drawn from the distributions, from −1 to 1, as in `analysis.search.objective`.
    seed
        Seed of the bootstrap.

    Returns
    -------
    Extrapolated or None
        ``None`` with fewer than `FEWEST_PEAKS` near misses, or if more than a tenth have the event.
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
    """Tails of samples of the same distances; a sample may contain a distance several times."""

    distances: FloatArray
    """Ascending, shape (n,)."""

    def fitted(self, samples: Iterable[IntArray]) -> list[tuple[float, int, float]]:
        """Return the probability of a distance below 0, the number of peaks, and the shape of each tail.

        A sample is given by how often it contains each distance. Samples without a tail are left out.
        """
        size = len(self.distances)
        if not size:
            return []
        rank = math.ceil((size - 1) * SHARE)
        # The samples share few thresholds, so what depends only on the threshold is computed once for each.
        by_threshold: dict[int, list[IntArray]] = {}
        for counts in samples:
            at = int(np.searchsorted(np.cumsum(counts), rank, side="right"))
            by_threshold.setdefault(at, []).append(counts[:at].copy())
        return [one for at, counts in by_threshold.items() for one in self._beyond(at, np.array(counts))]

    def _beyond(self, at: int, counts: IntArray) -> Iterator[tuple[float, int, float]]:
        """Yield the tails of samples with one threshold, from counts of shape (samples, at) below it."""
        threshold = float(self.distances[at])
        if not np.isfinite(threshold) or threshold <= 0.0:
            return
        first = int(np.searchsorted(self.distances, 0.0, side="right"))
        end = int(np.searchsorted(self.distances, threshold))
        # Maximum likelihood in one dimension. With shape ξ, scale σ and s the log of 1 + ξ · threshold / σ,
        # the best ξ for an s is a mean. Events only count as being beyond 0, because their margins have
        # another scale.
        logs = np.log1p(_RATIOS[:, None] * (1.0 - self.distances[first:end] / threshold))
        # BLAS is avoided, because its sums depend on the machine.
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
