"""The controllers of the egos, built when an ego first appears, each with a seed of its own."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterator, Mapping

from controllers.interface import Controller, Decision, Perception, Plan
from cosim.step.loop import ToWorld
from cosim.step.world import Snapshot


class Drivers(Mapping[str, Controller]):
    """A controller for every ego that is looked up; it drives that ego until the ego leaves.

    An ego's seed depends only on the run's seed and on the ego's name, so that one more ego in the traffic
    does not change what the others draw.
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

    def keep(self, names: Collection[str]) -> None:
        """Release all other egos' controllers: with its optimisation programs, one may hold some 200 kB."""
        for name in self._built.keys() - set(names):
            release(self._built.pop(name))

    def close(self) -> None:
        """Release all controllers."""
        self.keep(())


class Departures:
    """A record that releases the controllers of egos that have left the road; no ego comes back.

    Parameters
    ----------
    drivers : Drivers
    """

    def __init__(self, drivers: Drivers) -> None:
        self._drivers = drivers

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Do nothing: an ego that plans is on the road."""

    def stepped(self, snapshot: Snapshot) -> None:
        """Keep the controllers of the egos that are still on the road."""
        self._drivers.keep([ego.name for ego in snapshot.egos])


def release(controller: Controller) -> None:
    """Release a controller; if it holds more than memory, such as a process, it has a method ``close``."""
    close = getattr(controller, "close", None)
    if callable(close):
        close()


def seed_of(seed: int, name: str) -> int:
    """Return the seed of one ego's controller, from 0 to 2^32 − 1."""
    return int.from_bytes(hashlib.sha256(f"{seed}:{name}".encode()).digest()[:4], "big")
