"""A simulation that advances one plan at a time, when its caller asks for the next one."""

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
        The run to simulate; its controller drives no ego by itself here.

    Raises
    ------
    InputError
        If the simulation cannot be set up, or this process already has one.
    """

    def __init__(self, request: RunRequest) -> None:
        with _one_a_process():
            self._composition = compose(request)
        self._opened = ExitStack()
        self._opened.callback(self._composition.close)
        self._opened.enter_context(rarely_collected())
        self._world = self._composition.world
        self.perceptions: dict[str, Perception] = {}
        """Perceptions of the egos that have to plan now, by name."""
        self.snapshot: Snapshot | None = None
        """The true state of everybody after the last step."""
        self.over = False

    def driver(self, name: str) -> Controller:
        """Return the run's own controller for an ego, for actions that leave the driving to it."""
        return self._composition.drivers[name]

    def look(self) -> Snapshot:
        """Return the true state of everybody now."""
        self.snapshot = self._world.snapshot()
        return self.snapshot

    def sense(self) -> bool:
        """Find the egos that have to plan now, and return whether the simulation goes on."""
        found = None if self.over else self._world.sense()
        self.over = found is None
        self.perceptions = {one.ego.name: one for one in found or ()}
        return not self.over

    def act(self, commands: Mapping[str, Command]) -> None:
        """Give commands to the egos that have to plan now; SUMO drives those that get none."""
        for name in self.perceptions:
            self._world.act(name, commands.get(name, HAND_BACK))

    def advance(self) -> Snapshot:
        """Advance the simulation by one step, and return the true state after it."""
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
