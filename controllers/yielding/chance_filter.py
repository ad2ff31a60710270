"""Model predictive control with chance constraints, for the speed of one ego."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving.following import limit_now
from controllers.interface import Solves
from controllers.optimisation.settings import SolverSettings
from controllers.yielding.chance import Tightening, WalkingUncertainty, tightening
from controllers.yielding.chance_program import ChancePlan, ChanceProgram
from controllers.yielding.facing import Answer, Facing

LASTS = 2.0
"""The acceleration that the driver wants is expected to last for this long [s]."""
CLASSES = 3
"""Greatest number of passing classes that are solved [-]."""
UNSOLVED = "fallback_full_braking"
KEPT = 0.9
"""The present passing class is given up only for one that costs less than this share of its cost [-]."""


class ChanceFilter:
    """Plans a speed for each passing class and takes the cheapest.

    Parameters
    ----------
    program : program of one class
    unsure : how uncertain pedestrians' places become
    risk : ε, risk accepted for each pedestrian at each time
    side_margin : margin by which a disc is grown across the way [m]
    solver : its name is reported
    """

    def __init__(
        self,
        program: ChanceProgram,
        unsure: WalkingUncertainty,
        risk: float,
        side_margin: float,
        solver: SolverSettings,
    ) -> None:
        self._program, self._unsure, self._risk = program, unsure, risk
        self._side_margin, self._solver = side_margin, solver
        self._ahead: frozenset[str] = frozenset()

    def allowed(self, facing: Facing) -> Answer:
        """Return the cheapest plan and its mean acceleration until the next; without any, full braking."""
        people, ego = facing.people, facing.perception.ego
        if not len(people):
            self._ahead = frozenset()
            return Answer()
        asked = tightening(facing, self._side_margin, self._program.times, self._unsure, self._risk)
        concerned = np.flatnonzero(asked.counts.any(axis=1))
        if not len(concerned):
            self._ahead = frozenset()
            return Answer()
        behind, plan = self._cheapest(facing, asked, concerned)
        solves = Solves(self._solver.name, *self._program.memory.tally.take())
        name = people.names[int(concerned[0])]
        if plan is None:
            full = -ego.drive.max_deceleration
            return Answer(full, True, name, False, UNSOLVED, overridden=True, solves=solves)
        names = [people.names[i] for i in concerned]
        self._ahead = frozenset(names[behind:])
        interval = max(ego.plan_interval, 0.1)
        count = max(round(interval / float(self._program.times[0])), 1)
        return Answer(
            float(plan.acceleration[:count].mean()),
            True,
            name,
            passing=f"behind={'|'.join(names[:behind])} ahead={'|'.join(names[behind:])}",
            slack=plan.slack,
            solves=solves,
            times=self._program.times,
            along=plan.position,
            speed=plan.speed,
        )

    def _cheapest(
        self, facing: Facing, asked: Tightening, concerned: np.ndarray[tuple[int, ...], np.dtype[np.int64]]
    ) -> tuple[int, ChancePlan | None]:
        """Return how many of the first pedestrians are let pass in the cheapest plan, and that plan."""
        n = len(concerned)
        now = sum(facing.people.names[i] not in self._ahead for i in concerned)
        tried = list(dict.fromkeys([n, now, 0, n - 1]))[:CLASSES]
        best: tuple[float, int, ChancePlan | None] = (np.inf, n, None)
        for behind in tried:
            plan = self._planned(facing, asked, concerned[:behind], concerned[behind:])
            cost = plan.cost * (KEPT if behind == now else 1.0)
            if plan.solved and cost < best[0]:
                best = (cost, behind, plan)
        return best[1], best[2]

    def _planned(
        self,
        facing: Facing,
        asked: Tightening,
        behind: np.ndarray[tuple[int, ...], np.dtype[np.int64]],
        ahead: np.ndarray[tuple[int, ...], np.dtype[np.int64]],
    ) -> ChancePlan:
        ego = facing.perception.ego
        body, speed = ego.body, max(ego.speed, 0.0)
        before = asked.expected[behind] - asked.margin[behind]
        stops = np.minimum(facing.places[behind][:, None], before) - body.front
        upper = np.where(asked.counts[behind], np.maximum(stops, 0.0), np.inf).min(axis=0, initial=np.inf)
        past = asked.expected[ahead] + asked.margin[ahead] + body.rear_overhang
        lower = np.where(asked.counts[ahead], past, -np.inf).max(axis=0, initial=-np.inf)
        wanted = self._wanted(facing)
        problem = self._program.problem(
            speed,
            ego.acceleration,
            wanted,
            upper,
            np.minimum(lower, upper),
            max(min(ego.drive.max_acceleration, 2.0), 0.1),
        )
        return self._program.solve(problem, speed, ego.acceleration, wanted)

    def _wanted(self, facing: Facing) -> FloatArray:
        """Return the speeds at which the driver would drive [m/s]."""
        ego, times = facing.perception.ego, self._program.times
        limit = max(limit_now(facing.perception.road, ego.body.front), ego.speed)
        lasting = np.minimum(times, LASTS)
        return np.clip(ego.speed + facing.wanted * lasting, 0.0, limit)
