"""The parts of a control step, and what its programs take."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from time import perf_counter
from typing import Any

from controllers.conflicts import bystanders, path_conflicts
from controllers.optimisation import solve as solving
from controllers.safety.last_check import LastCheck
from controllers.velocity_obstacle.mpc import lateral, longitudinal, passing_classes
from controllers.velocity_obstacle.mpc.driver import VelocityObstacleMpc
from controllers.velocity_obstacle.mpc.lateral import LateralProgram
from controllers.velocity_obstacle.mpc.longitudinal import LongitudinalProgram
from controllers.velocity_obstacle.mpc.speed_planning import SpeedPlanner
from controllers.velocity_obstacle.mpc.speed_tasks import SpeedTasks
from measuring.stopwatch import OTHER, Stopwatch, replaced, watching

PREDICT, CONFLICTS, TASK, ASSEMBLY, SOLVE, VERIFY, CHECK = (
    "predict",
    "conflicts",
    "task",
    "assembly",
    "solve",
    "verify",
    "check",
)
PARTS = (PREDICT, CONFLICTS, TASK, ASSEMBLY, SOLVE, VERIFY, CHECK, OTHER)
PLACES = (
    (SpeedPlanner, "look", PREDICT),
    (path_conflicts, "expected", PREDICT),
    (path_conflicts, "find", CONFLICTS),
    (bystanders, "bystanders", CONFLICTS),
    (passing_classes, "class_bounds", CONFLICTS),
    (SpeedPlanner, "_candidates", CONFLICTS),
    (SpeedTasks, "task", TASK),
    (VelocityObstacleMpc, "_steering_task", TASK),
    (LongitudinalProgram, "build", ASSEMBLY),
    (LateralProgram, "build", ASSEMBLY),
    (solving, "certify", VERIFY),
    (LastCheck, "checked", CHECK),
)


class Programs:
    """How long each solve took, its certificate included, and how it ended."""

    def __init__(self) -> None:
        self.seconds: dict[str, list[float]] = {"speed": [], "steering": []}
        self.unsolved = 0
        """Programs without a solution whose certificate holds."""

    @property
    def count(self) -> int:
        """How many there were."""
        return sum(map(len, self.seconds.values()))


@contextmanager
def observed(programs: Programs, watch: Stopwatch | None = None) -> Iterator[None]:
    """Note every solve while inside; with a stopwatch, also time the parts of the step on it."""

    def timed(kind: str, solve: Any) -> Any:
        def noted(*args: Any, **kwargs: Any) -> Any:
            with watch.part(SOLVE) if watch is not None else nullcontext():
                began = perf_counter()
                solution = solve(*args, **kwargs)
                programs.seconds[kind].append(perf_counter() - began)
            programs.unsolved += not solution.solved
            return solution

        return noted

    with ExitStack() as stack:
        for kind, module in (("speed", longitudinal), ("steering", lateral)):
            stack.enter_context(replaced(module, "solve", timed(kind, module.solve)))
        if watch is not None:
            stack.enter_context(watching(watch, PLACES))
        yield
