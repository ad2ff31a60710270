"""Subset simulation [AuBeck2001]: approaches a rare event in levels, each a tenth as probable as the last.

Markov chains continue from the inputs below a level's threshold. Their steps keep the normal distribution
(conditional sampling [Papaioannou2015]), and a step that leaves the level is rejected. The region narrows
from level to level, so the width of the steps is adapted to it: with a constant width, hardly any step
would be accepted in the end, and the chains would repeat themselves. Chains continue only from inputs
strictly below the threshold, which makes the estimate unbiased for chains that forget where they began
[Brehier2016].
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from analysis.arrays import FloatArray

TAKEN = 0.44
"""Target share of accepted steps; the best one for a single number [Papaioannou2015]."""


def subset_simulation(
    evaluate: Callable[[FloatArray], FloatArray], dimension: int, *, level: int, share: float, seed: int
) -> float:
    """Return the probability of a margin below 0; 0 if no threshold leads further down.

    Parameters
    ----------
    evaluate
        Maps standard normal numbers, an array (n, dimension), to margins, an array (n).
    dimension
        Number of inputs.
    level
        Number of inputs per level.
    share
        Share of a level from which the next one continues.
    seed
    """
    generator = np.random.default_rng(seed)
    chains = round(share * level)
    inputs = generator.standard_normal((level, dimension))
    margins = evaluate(inputs)
    probability, width = 1.0, 1.0
    while True:
        threshold = float(np.sort(margins)[chains])
        if threshold <= 0.0:
            return probability * np.count_nonzero(margins < 0.0) / level
        below = np.flatnonzero(margins < threshold)  # fewer than the chains if margins are equal
        if not below.size:
            return 0.0
        probability *= below.size / level
        begin = np.resize(below, chains)
        states, values = [inputs[begin]], [margins[begin]]
        for step in range(1, level // chains):
            noise = generator.standard_normal((chains, dimension))
            proposed = math.sqrt(1.0 - width**2) * states[-1] + width * noise
            found = evaluate(proposed)
            taken = found < threshold
            states.append(np.where(taken[:, np.newaxis], proposed, states[-1]))
            values.append(np.where(taken, found, values[-1]))
            width = min(1.0, width * math.exp((float(np.mean(taken)) - TAKEN) / math.sqrt(step)))
        inputs, margins = np.concatenate(states), np.concatenate(values)
