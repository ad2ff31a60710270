"""A simulation that is driven one plan at a time, by whoever asks for the next one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager

from controllers.interface import HAND_BACK, Command, Controller, Perception
from cosim.errors import InputError, SimulationError
from cosim.running.compose import compose
from cosim.running.request import RunRequest
from cosim.step.loop import rarely_collected
from cosim.step.world import MapArea, Snapshot

BUSY = (
    "this process runs a simulation already, and SUMO allows one a process: close the other environment or "
    "run, or give each environment its process (gymnasium.vector.AsyncVectorEnv)"
)


class Session:
    """One simulation from its start to its end.

    Parameters
    ----------
    request
        What is simulated; its controller drives nobody here.

    Raises
    ------
    InputError
        If it cannot be made, or this process has a simulation already.
    """

    def __init__(self, request: RunRequest) -> None:
        with _one_a_process():
            self._composition = compose(request)
        self._opened = ExitStack()
        self._opened.callback(self._composition.close)
        self._opened.enter_context(rarely_collected())
        self._world = self._composition.world
        self.perceptions: dict[str, Perception] = {}
        """Of the egos that are to plan now, by name."""
        self.snapshot: Snapshot | None = None
        """The truth after the last step."""
        self.over = False

    def driver(self, name: str) -> Controller:
        """Return the run's own controller for an ego, for agents that leave the driving to it."""
        return self._composition.drivers[name]

    def look(self) -> Snapshot:
        """Return the truth now."""
        self.snapshot = self._world.snapshot()
        return self.snapshot

    def sense(self) -> bool:
        """Find out which egos are to plan now; return whether the simulation goes on."""
        found = None if self.over else self._world.sense()
        self.over = found is None
        self.perceptions = {one.ego.name: one for one in found or ()}
        return not self.over

    def act(self, commands: Mapping[str, Command]) -> None:
        """Tell egos what to do from now on; SUMO drives those that have been told nothing."""
        for name in self.perceptions:
            self._world.act(name, commands.get(name, HAND_BACK))

    def advance(self) -> Snapshot:
        """Move everything by one step, and return the truth after it."""
        self._world.advance()
        return self.look()

    def map_areas(self) -> list[MapArea]:
        """Return lanes, crossings and walking areas near where the egos have been."""
        return list(self._world.map_areas())

    def close(self) -> None:
        """End the simulation; a second call does nothing."""
        self.over = True
        self._opened.close()


@contextmanager
def _one_a_process() -> Iterator[None]:
    try:
        yield
    except SimulationError as error:
        raise InputError(BUSY if "runs a simulation already" in str(error) else str(error)) from error
