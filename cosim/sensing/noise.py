"""Random numbers that depend only on the measured object, the sensor and the time."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosim.arrays import FloatArray

_TICKS = 64
"""Number of ticks for which numbers are drawn at once."""
_MOST_KEPT = 256
"""When more blocks than this are kept, those of former ticks are dropped."""


@dataclass(frozen=True, slots=True)
class Draws:
    """Random numbers, with one row for each name."""

    normal: FloatArray
    """(n, 4) standard normal."""
    uniform: FloatArray
    """(n,) from 0 to 1."""
    exponential: FloatArray
    """(n,) of mean 1."""


class Noise:
    """Draws by name and tick, independent of other draws and their order.

    So the same pedestrian is measured with the same error at the same instant, whichever controller drives
    and whichever pedestrians were seen before. Runs with the same seed are therefore paired.

    Parameters
    ----------
    seed : seed of the run
    source : name of what measures; different sources draw independently
    """

    def __init__(self, seed: int, source: str) -> None:
        self._prefix = f"{seed}:{source}:"
        self._blocks: dict[str, tuple[int, FloatArray]] = {}

    def draw(self, names: Sequence[str], tick: int) -> Draws:
        """Return the random numbers of these names at a tick."""
        block, row = divmod(tick, _TICKS)
        if len(self._blocks) > _MOST_KEPT:
            self._blocks = {name: kept for name, kept in self._blocks.items() if kept[0] == block}
        table = np.empty((len(names), 6))
        for index, name in enumerate(names):
            known = self._blocks.get(name)
            if known is None or known[0] != block:
                known = self._blocks[name] = (block, self._block(name, block))
            table[index] = known[1][row]
        return Draws(table[:, :4], table[:, 4], table[:, 5])

    def _block(self, name: str, block: int) -> FloatArray:
        digest = hashlib.sha256(f"{self._prefix}{name}".encode()).digest()[:16]
        bits = np.random.Philox(key=int.from_bytes(digest, "big"), counter=[0, block, 0, 0])
        generator = np.random.Generator(bits)
        columns = (
            generator.standard_normal((_TICKS, 4)),
            generator.random((_TICKS, 1)),
            generator.standard_exponential((_TICKS, 1)),
        )
        return np.concatenate(columns, axis=1)
