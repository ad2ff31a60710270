"""The parts of a control step, and how often its programs needed a solver."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from time import perf_counter
from typing import Any

from controllers.conflicts import passing
from controllers.mpc.driver import VelocityObstacleMpc
from controllers.mpc.lateral import LateralProgram
from controllers.mpc.longitudinal import LongitudinalProgram
from controllers.mpc.speed_planning import SpeedPlanner
from controllers.programs.qp import Program
from measuring.stopwatch import OTHER, Stopwatch, replaced, watching

PREDICT, CONFLICTS, TASK, ASSEMBLY, SOLVE, VERIFY = (
    "predict",
    "conflicts",
    "task",
    "assembly",
    "solve",
    "verify",
)
PARTS = (PREDICT, CONFLICTS, TASK, ASSEMBLY, SOLVE, VERIFY, OTHER)
PLACES = (
    (SpeedPlanner, "look", PREDICT),
    (passing, "_expected_motion", PREDICT),
    (passing, "find", CONFLICTS),
    (passing, "class_bounds", CONFLICTS),
    (SpeedPlanner, "_candidates", CONFLICTS),
    (SpeedPlanner, "_task", TASK),
    (VelocityObstacleMpc, "_steering_task", TASK),
    (LongitudinalProgram, "build", ASSEMBLY),
    (LateralProgram, "build", ASSEMBLY),
)


class Programs:
    """How long each solve took, and how it ended."""

    def __init__(self) -> None:
        self.seconds: dict[str, list[float]] = {"speed": [], "steering": []}
        self.near = 0
        """Programs whose optimum was found near the last active rows."""
        self.solver = 0
        """Programs handed to the solver."""

    @property
    def share_near(self) -> float:
        """Share of the programs that no solver was called for."""
        return self.near / max(self.near + self.solver, 1)


@contextmanager
def observed(programs: Programs, watch: Stopwatch | None = None) -> Iterator[None]:
    """Note every solve while inside; with a stopwatch, also count solves and verification on it.

    All rows are verified within a solve, at least once. One such pass is timed beside each solve, and that
    much of it counts as verification.
    """
    solve, near, steer = Program.solve, Program._near_the_last, LateralProgram.solve
    steering: list[LateralProgram] = []
    """Whose program is being solved, if it is one."""

    def noted(self: Program, *args: Any, **kwargs: Any) -> Any:
        kind = "steering" if steering else "speed"
        if watch is None:
            began = perf_counter()
            solution = solve(self, *args, **kwargs)
            programs.seconds[kind].append(perf_counter() - began)
            return solution
        with watch.part(SOLVE):
            began = perf_counter()
            solution = solve(self, *args, **kwargs)
            programs.seconds[kind].append(perf_counter() - began)
        with watch.part("beside"):
            began = perf_counter()
            (self._rows @ solution.z - self._bounds).argmax()
            once = perf_counter() - began
        watch.moved(once, SOLVE, VERIFY)
        return solution

    def counted(self: Program, *args: Any) -> Any:
        found = near(self, *args)
        if found is None:
            programs.solver += 1
        else:
            programs.near += 1
        return found

    def steered(self: LateralProgram, *args: Any, **kwargs: Any) -> Any:
        steering.append(self)
        try:
            return steer(self, *args, **kwargs)
        finally:
            steering.pop()

    with ExitStack() as stack:
        stack.enter_context(replaced(LateralProgram, "solve", steered))
        stack.enter_context(replaced(Program, "solve", noted))
        stack.enter_context(replaced(Program, "_near_the_last", counted))
        if watch is not None:
            stack.enter_context(watching(watch, PLACES))
        yield
