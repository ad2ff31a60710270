"""Who drives which ego: controllers built when an ego first appears, each with a seed of its own."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping

from controllers.interface import Controller


class Drivers(Mapping[str, Controller]):
    """A controller for every ego that is asked for; one controller drives one ego for the whole run.

    An ego's seed follows from the run's seed and from its name alone, so that one more ego in the
    traffic does not change what the others draw.
    """

    def __init__(self, build: Callable[[int], Controller], seed: int) -> None:
        self._build = build
        self._seed = seed
        self._built: dict[str, Controller] = {}

    def __getitem__(self, name: str) -> Controller:
        if name not in self._built:
            self._built[name] = self._build(seed_of(self._seed, name))
        return self._built[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._built)

    def __len__(self) -> int:
        return len(self._built)


def seed_of(seed: int, name: str) -> int:
    """Return the seed of one ego's controller, from 0 to 2^32 − 1."""
    return int.from_bytes(hashlib.sha256(f"{seed}:{name}".encode()).digest()[:4], "big")
