"""Speed plans on the way into a lane: who bounds the position, and which passing class is cheapest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.conflicts import bystanders, path_conflicts
from controllers.conflicts.expected_behaviour import Expectation, Watch, expected
from controllers.conflicts.path_conflicts import Conflicts
from controllers.driving.keep_clear import keep_clear_of_people
from controllers.driving.right_of_way import RightOfWay
from controllers.interface import Lane, Perception
from controllers.optimisation.solve import Memory
from controllers.prediction.forecast import Forecast, Predictor
from controllers.safety.way_out import FREE, Reach
from controllers.velocity_obstacle.mpc import passing_classes
from controllers.velocity_obstacle.mpc.arithmetic import passing_bounds, position_bounds
from controllers.velocity_obstacle.mpc.lateral import SteeringPlan
from controllers.velocity_obstacle.mpc.longitudinal import (
    LongitudinalProgram,
    SpeedLimits,
    SpeedPlan,
    SpeedTask,
)
from controllers.velocity_obstacle.mpc.passing_classes import ClassBounds
from controllers.velocity_obstacle.mpc.passing_settings import PassingSettings
from controllers.velocity_obstacle.mpc.plan_memory import PlanMemory
from controllers.velocity_obstacle.mpc.speed_tasks import (
    SLOW,
    STOPPING_FOR_PEOPLE,
    SpeedTasks,
    stopping_within,
    swept,
)

REACHED = 0.3
"""A bound that is nearer to a plan than this counts as having shaped it [m]."""
STUCK_WITHIN = 0.5
"""An ego that cannot go as far as this counts as unable to move [m]."""
STOOD_LONG = 15.0
"""People who have stood before the waiting ego for this long are not going to move first [s]."""
FORECAST_SPACING = 0.1
"""Time step of the predictions; in between, people are expected to go straight on [s]."""


@dataclass(frozen=True, slots=True)
class Chosen:
    """The speed plan of the cheapest passing class for one lane."""

    plan: SpeedPlan
    conflicts: Conflicts
    behind: int
    because: str
    """What bounds the position first: a signal, a crossing, a pedestrian or a vehicle; empty for nothing."""
    steering: SteeringPlan | None = None
    """Steering plan, if speed and steering were planned together."""
    too_far: float = 0.0
    """How far the plan goes beyond the point where people let go first should stop it [m]."""
    reach: Reach = FREE
    """How far a slow ego may go, and whether it is stuck."""
    bound: bool = False
    """Whether the class's bounds for pedestrians shape the plan, which would differ without them."""


@dataclass(slots=True)
class SpeedPlanner:
    """Makes speed plans, and remembers which pedestrians the ego has decided to pass ahead of."""

    settings: PassingSettings
    program: LongitudinalProgram
    memory: PlanMemory
    right_of_way: RightOfWay
    predictor: Predictor | None = None
    """Predicts where pedestrians will be; ``None``: they keep their velocities, in closed form."""
    solves: Memory = field(default_factory=Memory)
    """Memory for solving the speed programs."""
    forecast: Forecast | None = None
    """Forecast at the present instant; ``None`` without a predictor."""
    settled_from: float = np.inf
    """Position where the lane change is over; people farther ahead are met in the target lane only [m]."""
    _ahead: dict[str, bool] = field(default_factory=dict)
    _reconsidered: float = -np.inf
    _watch: Watch = field(default_factory=Watch)
    _expectation: Expectation = field(init=False)
    _bounds: tuple[Conflicts, SpeedTask, ClassBounds] | None = None
    # The bounds, with the conflicts and the task that they were computed for.
    _tasks: SpeedTasks = field(init=False)

    def __post_init__(self) -> None:
        self._tasks = SpeedTasks(self.settings, self.program.limits, self.memory, self.right_of_way)

    def look(self, perception: Perception, waiting_place: float = np.inf) -> None:
        """Take note of signals, of vehicles with priority, and of where people will be; once per plan.

        Parameters
        ----------
        perception
            What the ego perceives.
        waiting_place
            Where the front bumper waits in the present lane for a change to another; inf for nowhere [m].
        """
        self._tasks.look(perception, waiting_place)
        if self.predictor is not None:
            count = int(np.ceil(self.memory.times[-1] / FORECAST_SPACING))
            times = np.linspace(0.0, count * FORECAST_SPACING, count + 1)
            self.forecast = self.predictor.predict(perception, times)
        self._expectation = expected(perception, self._watch, self.settings.assume, self.forecast)

    @property
    def may_enter(self) -> NDArray[np.bool_]:
        """Which pedestrians may come into the ego's way but are not there yet, shape (n,)."""
        return self._expectation.enters

    @property
    def comes(self) -> FloatArray | None:
        """Across speeds that are known better than from the velocities now; see ``Expectation``."""
        return self._expectation.comes

    def _band(
        self, perception: Perception, lane: Lane | None
    ) -> tuple[float | FloatArray, float | FloatArray]:
        """Return the right and left edge of what the body sweeps where it meets each pedestrian [m]."""
        right, left = swept(perception, lane)
        if lane is None or np.isinf(self.settled_from):
            return right, left
        half, settled = 0.5 * perception.ego.body.width, perception.pedestrians.along > self.settled_from
        return np.where(settled, lane.offset - half, right), np.where(settled, lane.offset + half, left)

    def nearest_stop(self) -> str:
        """Return the name of the nearest signal or vehicle that the ego has to stop for; empty for none."""
        stops = self._tasks.stops
        return min(stops, key=lambda stop: stop.along).name if stops else ""

    def commit(self, perception: Perception, chosen: Chosen) -> None:
        """Remember the passing class that is followed from now on."""
        if self._due(perception):
            self._reconsidered = perception.ego.time
        self._ahead = {name: i >= chosen.behind for i, name in enumerate(chosen.conflicts.names)}

    def cheapest(self, perception: Perception, lane: Lane | None, leaving_for: float) -> Chosen:
        """Return the cheapest passing class on the way into a lane.

        Parameters
        ----------
        perception
            What the ego perceives.
        lane
            Lane that the ego drives to; ``None``: straight on.
        leaving_for
            How long the vehicles ahead in the present lane still count when another lane is the target [s].
        """
        s, times = self.settings, self.memory.times
        offset = lane.offset if lane is not None else 0.0
        beside = bystanders.bystanders(
            perception,
            offset,
            self.may_enter,
            self._expectation.sets_off,
            lambda places: self.memory.arrives(perception.ego, places),
        )
        right, left = bystanders.swing_out(perception.road, perception.ego.body, perception.pedestrians.along)
        band = self._band(perception, lane)
        conflicts = path_conflicts.find(
            perception,
            self._watch,
            (band[0] - right, band[1] + left),
            s.margin_across,
            float(times[-1]),
            s.assume,
            self.forecast,
            # Pedestrians beside the body can be passed neither behind, as the bumper is past them, nor ahead,
            # as pulling forward would be a race. They are left to the last check.
            abreast=False,
            clearance=None if beside is None else beside.least(len(perception.pedestrians)),
            expectation=self._expectation,
        )
        slowly = None if beside is None else beside.speed_limit(conflicts.index)
        task, because, waits_at = self._tasks.task(perception, lane, leaving_for, self._watch, slowly)
        best: Chosen | None = None
        best_cost = np.inf
        flips = self._flips(conflicts)
        for behind in self._candidates(perception, conflicts, task, flips):
            if best is not None and self._least_cost(perception, task, conflicts, behind) > best_cost:
                continue
            plan, steering = self._solve_class(perception, lane, task, conflicts, behind)
            # A change of class has to be worth it.
            cost = plan.cost / (s.hysteresis if flips[behind] else 1.0)
            if plan.found and (best is None or cost < best_cost):
                who = because or (conflicts.names[0] if len(conflicts) else "")
                best, best_cost = Chosen(plan, conflicts, behind, who, steering), cost
        if best is None:
            return Chosen(self._nothing(perception.ego.speed), conflicts, len(conflicts), because)
        return self._judged(perception, task, best, waits_at)

    def _judged(self, perception: Perception, task: SpeedTask, chosen: Chosen, waits_at: float) -> Chosen:
        """Return a choice with ``bound``, ``too_far`` and, for a slow ego, ``reach`` set."""
        ego, conflicts, behind = perception.ego, chosen.conflicts, chosen.behind
        if len(conflicts):
            bounds = self._class_bounds(perception, task, conflicts)
            chosen = replace(chosen, bound=_reaches(bounds, behind, chosen.plan, self.program.limits))
        to_people, too_far = np.inf, 0.0
        if behind:
            upper = self._class_bounds(perception, task, conflicts).upper[behind]
            to_people = float(upper.min())
            too_far = max(float((chosen.plan.position - upper).max()), 0.0)
        if ego.speed >= SLOW:
            return replace(chosen, too_far=too_far) if too_far else chosen
        to_others = float(min(task.upper.min(), task.headway.min()))
        reach = self._reach(perception, chosen, to_people, to_others, waits_at)
        return replace(chosen, too_far=too_far, reach=reach)

    def _reach(
        self, perception: Perception, chosen: Chosen, to_people: float, to_others: float, waits_at: float
    ) -> Reach:
        """Return how far a slow ego may go, given how far people and its other bounds let it [m]."""
        farthest = min(to_people, to_others)
        front, conflicts, behind = perception.ego.body.front, chosen.conflicts, chosen.behind
        names = conflicts.names[:behind]
        # A plan may stay short of its bounds, and stands all the same before people who stay there.
        if names and min(self._watch.waited.get(name, 0.0) for name in names) >= STOOD_LONG:
            farthest = min(farthest, float(chosen.plan.position[-1]))
        # Who has stood before the waiting ego may wait for it to leave, on the crossing too.
        goes_on = (self.may_enter & ~self._expectation.lets_go)[conflicts.index[:behind]]
        _, places, _ = passing_classes.stops(conflicts, behind, front, self.settings.margin_along)
        to_stop = waits_at - front
        room = min(to_stop, float(places[goes_on].min(initial=np.inf)) - front)
        return Reach(farthest < STUCK_WITHIN < room, room, to_stop, to_people)

    def _solve_class(
        self,
        perception: Perception,
        lane: Lane | None,
        task: SpeedTask,
        conflicts: Conflicts,
        behind: int,
    ) -> tuple[SpeedPlan, SteeringPlan | None]:
        """Return the plan for one passing class, with the steering plan if that was made too."""
        bounded = self._bounded(perception, task, conflicts, behind)
        plan = self._solve(bounded)
        if not len(conflicts) or not plan.found:
            return plan, None
        lower = self._class_bounds(perception, task, conflicts).lower[behind]
        return self._priced(plan, float(np.maximum(lower - bounded.upper, 0.0).max())), None

    def _solve(self, task: SpeedTask) -> SpeedPlan:
        """Solve sequential QPs: each linearises the braking distance about the plan of the previous pass."""
        plan = self.program.solve(task, memory=self.solves)
        for _ in range(self.settings.passes - 1):
            if not plan.found or not self.program.worth_another_pass(task, plan):
                break
            task = task._replace(expected=plan.speed)
            better = self.program.solve(task, start=plan.inputs, memory=self.solves)
            if not better.found:
                break
            plan = better
        return plan

    def _candidates(
        self,
        perception: Perception,
        conflicts: Conflicts,
        task: SpeedTask,
        flips: Sequence[int],
    ) -> list[int]:
        """Return the passing classes to solve: the present one and those nearest to being reachable."""
        s, n = self.settings, len(conflicts)
        if n == 0:
            return [0]
        bounds = self._class_bounds(perception, task, conflicts)
        limits, speed = self.program.limits, perception.ego.speed
        short = passing_bounds.shortfalls(
            bounds.lower,
            bounds.upper,
            task.upper,
            self.memory.times,
            speed,
            task.wanted,
            limits.acceleration,
            limits.comfortable_braking,
        )
        far = (short > 0.5).tolist()
        if not self._due(perception) or self._locked(perception, conflicts):
            same = [behind for behind in range(n + 1) if flips[behind] == 0 and not far[behind]]
            if same and all(name in self._ahead for name in conflicts.names):
                return same[: s.max_classes]
        scored = sorted((far[behind], flips[behind], -behind, behind) for behind in range(n + 1))
        chosen = [behind for *_, behind in scored][: s.max_classes]
        # The class that lets everybody go first is always tried.
        return chosen if n in chosen else [*chosen[: s.max_classes - 1], n]

    def _least_cost(
        self, perception: Perception, task: SpeedTask, conflicts: Conflicts, behind: int
    ) -> float:
        """Return the least cost of a class's violated bounds, however hard the ego brakes or accelerates."""
        limits, weights, times = self.program.limits, self.program.weights, self.memory.times
        speed = perception.ego.speed
        farthest = speed * times + 0.5 * limits.acceleration * times**2
        t = np.minimum(times, speed / limits.emergency_braking)
        nearest = speed * t - 0.5 * limits.emergency_braking * t**2
        bounds = self._class_bounds(perception, task, conflicts)
        late = float(np.maximum(bounds.lower[behind] - farthest, 0.0).max())
        soon = float(np.maximum(nearest - bounds.upper[behind], 0.0).max())
        return weights.violation * (late + soon) + weights.violation_squared * (late**2 + soon**2)

    def _due(self, perception: Perception) -> bool:
        """Return whether it is time to consider all passing classes again."""
        return perception.ego.time - self._reconsidered >= self.settings.reconsider - 1e-9

    def _locked(self, perception: Perception, conflicts: Conflicts) -> bool:
        """Return whether the class is kept because the ego is about to arrive."""
        if perception.ego.speed < 1.0:
            return False
        places = zip(conflicts.names, conflicts.along.tolist(), strict=True)
        nearest = min((along for name, along in places if name in self._ahead), default=np.inf)
        return (nearest - perception.ego.body.front) / perception.ego.speed < self.settings.lock

    def _flips(self, conflicts: Conflicts) -> list[int]:
        """Return, for each class, for how many pedestrians it differs from the class followed now."""
        ahead = [self._ahead.get(name) for name in conflicts.names]
        flips = [ahead.count(False)]
        for one in ahead:  # the next class passes behind this pedestrian
            flips.append(flips[-1] + (one is not None) * (1 if one else -1))
        return flips

    def _bounded(
        self, perception: Perception, task: SpeedTask, conflicts: Conflicts, behind: int
    ) -> SpeedTask:
        """Return the task with the pedestrians of one passing class in it."""
        if not len(conflicts):
            return task
        bounds = self._class_bounds(perception, task, conflicts)
        front, people = perception.ego.body.front, bounds.upper[behind]
        # An ego whose body would stand on a crossing while it waits for a pedestrian stops before that
        # crossing.
        stops = passing_classes.stops(conflicts, behind, front, self.settings.margin_along)
        line = keep_clear_of_people(perception, conflicts.index[:behind], *stops)
        before = max(line - position_bounds.BEFORE_LINE - front, 0.0)
        upper = np.minimum(task.upper, np.minimum(people, before))
        stoppable = np.minimum(bounds.freeze[behind], max(line - front, 0.0))
        slower = stopping_within(stoppable - task.positions, braking=STOPPING_FOR_PEOPLE)
        return task._replace(
            reference=np.minimum(task.reference, slower),
            upper=upper,
            # Upper bounds from people and vehicles outrank going ahead of a pedestrian: nothing pulls the ego
            # beyond them.
            lower=np.minimum(np.maximum(task.lower, bounds.lower[behind]), upper),
            stoppable=np.minimum(task.stoppable, stoppable),
        )

    def _priced(self, plan: SpeedPlan, short: float) -> SpeedPlan:
        """Return a plan whose cost and slack include ``short``, by which its class's bounds conflict [m]."""
        if short == 0.0:
            return plan
        w = self.program.weights
        price = w.violation * short + w.violation_squared * short**2
        return plan._replace(cost=plan.cost + price, slack=max(plan.slack, short))

    def _class_bounds(self, perception: Perception, task: SpeedTask, conflicts: Conflicts) -> ClassBounds:
        """Return the bounds of all classes, computed once for the same conflicts and task."""
        known = self._bounds
        if known is None or known[0] is not conflicts or known[1] is not task:
            body = perception.ego.body
            bounds = passing_classes.class_bounds(
                conflicts,
                self.memory.times,
                body.front,
                body.rear_overhang,
                self.settings.margin_along,
                task.expected,
            )
            known = self._bounds = (conflicts, task, bounds)
        return known[2]

    def _nothing(self, speed: float) -> SpeedPlan:
        times = self.memory.times
        none = np.zeros(len(times))
        return SpeedPlan(False, speed * times, none + speed, none, none, np.inf, 0.0, 0.0, none)


def _reaches(bounds: ClassBounds, behind: int, plan: SpeedPlan, limits: SpeedLimits) -> bool:
    """Return whether a plan comes close to the bounds of a class, or to the braking that they require."""
    stopped = plan.position + plan.speed**2 / (2.0 * limits.emergency_braking)
    late = plan.position > bounds.upper[behind] - REACHED
    early = plan.position < bounds.lower[behind] + REACHED
    return bool((late | early | (stopped > bounds.freeze[behind] - REACHED)).any())


def with_margins(perception: Perception, gain: float) -> Perception:
    """Return the perception with pedestrians' discs enlarged by ``gain`` standard deviations of position."""
    people = perception.pedestrians
    if gain == 0.0 or not people.uncertainty.any():
        return perception
    grown = replace(people, radius=people.radius + gain * people.uncertainty)
    return replace(perception, pedestrians=grown)
