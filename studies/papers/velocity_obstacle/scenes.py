"""The scenes of the velocity-obstacle paper, and drives of its controller in the paper's discrete world.

The paper's x points to the right and its y forward; here, ``along`` is its y and ``across`` its −x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from controllers.arrays import FloatArray
from controllers.optimisation.settings import SolverSettings
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.paper.cone_margins import People
from controllers.velocity_obstacle.paper.euler_bicycle import EulerBicycle
from controllers.velocity_obstacle.paper.passing_classes import QuadraticOptimiser, class_jumps, of_class
from controllers.velocity_obstacle.paper.problem import AvoidanceProblem, End, all_room
from controllers.velocity_obstacle.paper.sequential_programs import AvoidancePlan, AvoidanceProgram

STEP = 1.0
WHEELBASE = 2.6
START_SPEED = 7.5
RADIUS = 2.0
HCM_RADIUS = 1.34
"""Radius of the Highway Capacity Manual, which the paper's text mentions before it uses 2 m [m]."""
LANE = 3.5
"""Distance between the centres of two lanes, which the paper does not give [m]."""
DEGREES = (180.0 / np.pi) ** 2
"""Weight with which a change of the wheel angle by 1° counts as much as one of the speed by 1 m/s."""
CONVERGED = 60
"""Number of programs after which a plan counts as the optimum."""
AHEAD, BEHIND = 0, 1
"""Passing classes of one pedestrian: the number of pedestrians who pass first."""

LISTED_AT_ONE = 1.0
"""Convention B: sample i of the pedestrian is at i seconds [s]."""
LISTED_AT_ZERO = 0.0
"""Convention A: sample 1 of the pedestrian is at the start [s]."""


@dataclass(frozen=True, slots=True)
class Scene:
    """One experiment; the pedestrian walks by (−1, 1) m/s from x = 6 m."""

    name: str
    steps: int
    first_y: float
    """y of the pedestrian's first sample [m]."""
    crossing_y: float
    """y of the crossing point x = 0 [m]."""


E1 = Scene("E1", 11, 40.0, 46.0)
E2 = Scene("E2", 11, 50.0, 56.0)
E3 = Scene("E3", 12, 40.0, 46.0)


def people(scene: Scene, radius: float = RADIUS, listed_at: float = LISTED_AT_ONE) -> People:
    """Return the pedestrian at the ends of the steps; to pass ahead of them means to pass on their left.

    Parameters
    ----------
    scene : the experiment
    radius : radius of vehicle and pedestrian together [m]
    listed_at : time of the first listed sample [s]
    """
    walked = STEP * np.arange(1.0, scene.steps + 1.0) - listed_at
    along, across = scene.first_y + walked, walked - 6.0
    one = np.ones((1, scene.steps))
    return People(along[None], across[None], one, one, np.ones(1), radius * one)


def problem(
    scene: Scene,
    *,
    cone: Cone = Cone.VO,
    radius: float = RADIUS,
    listed_at: float = LISTED_AT_ONE,
    steers: bool = False,
    steering_weight: float = 1.0,
    end: End | None = None,
) -> AvoidanceProblem:
    """Return a scene's optimisation problem; parameters as for the problem itself."""
    return AvoidanceProblem(
        bicycle=EulerBicycle(WHEELBASE, STEP),
        start=np.array([0.0, 0.0, 0.0, START_SPEED, 0.0]),
        people=people(scene, radius, listed_at),
        room=all_room(scene.steps),
        cone=cone,
        steers=steers,
        steering_weight=steering_weight,
        end=end,
    )


def lane_change(steering_weight: float, *, along: float | None = None) -> AvoidanceProblem:
    """Return experiment 3 with an end in the right lane.

    Parameters
    ----------
    steering_weight : w of the objective [(m/s)^2/rad^2]
    along : position of the end along the road; ``None`` for anywhere [m]
    """
    end = End(E3.steps, along=along, across=-LANE, heading=0.0, steering=0.0)
    return problem(E3, steers=True, steering_weight=steering_weight, end=end)


def optimum(one: AvoidanceProblem, behind: int) -> AvoidancePlan:
    """Return the optimum of a passing class: sequential quadratic programs until nothing changes."""
    optimiser = QuadraticOptimiser(passes=CONVERGED, solver=SolverSettings("osqp", tolerance=1e-6))
    return optimiser.solve_class(one, behind, class_jumps(one)[1][behind])


def driven_cost(one: AvoidanceProblem, passes: int, *, simple_starts: bool = True) -> float:
    """Return J of a drive that replans both classes at every step, over the remaining horizon [(m/s)^2].

    Parameters
    ----------
    one : the scene's problem
    passes : quadratic programs per class and step
    simple_starts : whether to start also from the best of simple plans, not only from the last plan
    """
    inputs: list[FloatArray] = []
    state = one.start
    last: dict[int, FloatArray] = {}
    for step in range(one.steps):
        rest = _rest(one, step, state)
        plans = {}
        for behind in (AHEAD, BEHIND):
            solve = _solve if simple_starts else _solve_plainly
            plans[behind] = solve(rest, behind, passes, last.get(behind))
            last[behind] = plans[behind].inputs[:, 1:]
        best = min(plans.values(), key=lambda plan: plan.merit)
        inputs.append(best.inputs[:, 0])
        state = best.states[:, 1]
    return float(one.cost(np.array(inputs).T))


def _solve(one: AvoidanceProblem, behind: int, passes: int, last: FloatArray | None) -> AvoidancePlan:
    return QuadraticOptimiser(passes).solve_class(one, behind, class_jumps(one)[1][behind], last)


def _solve_plainly(one: AvoidanceProblem, behind: int, passes: int, last: FloatArray | None) -> AvoidancePlan:
    fixed = of_class(one, behind)
    ends = len(one.end.targets()) if one.end is not None else 0
    program = AvoidanceProgram(one.steps, 1, one.steers, ends)
    return program.solve(fixed, fixed.wanted_inputs() if last is None else last, passes)


def _rest(one: AvoidanceProblem, step: int, state: FloatArray) -> AvoidanceProblem:
    """Return the remaining problem after some steps."""
    p = one.people
    left = People(
        p.along[:, step:], p.across[:, step:], p.along_speed[:, step:], p.across_speed[:, step:], p.side,
        p.radius[:, step:],
    )  # fmt: skip
    end = None if one.end is None else replace(one.end, step=one.end.step - step)
    return replace(one, start=state, people=left, room=all_room(one.steps - step), end=end)


def arrival(states: FloatArray, along: float) -> float:
    """Return when a motion in Euler steps reaches a position along the road; inf if it never does [s]."""
    places = states[0]
    passed = np.flatnonzero(places >= along)
    if not len(passed):
        # Beyond the horizon, the motion continues at the last speed.
        speed = float(states[3, -1])
        return STEP * (len(places) - 1) + (along - float(places[-1])) / speed if speed > 0.0 else math.inf
    after = int(passed[0])
    share = (along - places[after - 1]) / (places[after] - places[after - 1])
    return STEP * (after - 1 + float(share))


def risk_perception(distance: FloatArray, speed: FloatArray) -> FloatArray:
    """Return the paper's coefficient k = l / v, Eq. (32) of [VOMPC2019]_ [s].

    Parameters
    ----------
    distance : l, distance to the end of the manoeuvre [m]
    speed : v, speed [m/s]

    >>> round(float(risk_perception(np.array(43.0 - 13.5), np.array(7.5))), 3)
    3.933
    """
    return np.asarray(distance / speed)


def printed_rejections(states: FloatArray, scene: Scene, radius: float = RADIUS) -> list[int]:
    """Return the steps at which the paper's inequality (16), exactly as printed, forbids a motion.

    The printed inequality is one-sided and takes the principal arctangent of the pedestrian's velocity minus
    the vehicle's.
    """
    who = people(scene, radius)
    x, y = -states[1, 1:], states[0, 1:]
    turned = 0.5 * np.pi + states[2, 1:]
    v = states[3, 1:]
    ox, oy = -who.across[0], who.along[0]
    vx, vy = -who.across_speed[0], who.along_speed[0]
    alpha = _principal(oy - y, ox - x)
    half = np.arcsin(np.minimum(radius / np.hypot(ox - x, oy - y), 1.0))
    angle = _principal(vy - v * np.sin(turned), vx - v * np.cos(turned))
    return [int(i) + 1 for i in np.flatnonzero(~(angle - alpha > half - 1e-9))]


def _principal(y: FloatArray, x: FloatArray) -> FloatArray:
    """Return arctan(y / x) between −90 and 90 degrees, also if x is zero [rad]."""
    return np.asarray(np.arctan2(np.where(x < 0.0, -y, y), np.abs(x)))
