"""The four situations of the drivable-area paper, as planning problems."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from controllers.arrays import FloatArray
from controllers.drivable_area.avoidance import choose
from controllers.drivable_area.braking_profile import TrapezoidalBraking
from controllers.drivable_area.clearances import Shape
from controllers.drivable_area.drivable_entropy import EntropyAt, EntropyMode
from controllers.drivable_area.evaluation import CarLimits, Rules, Scene, Verdict, judge
from controllers.drivable_area.pareto_search import Budget, Front
from controllers.drivable_area.quintic_path import PathStart
from controllers.interface import Body
from controllers.prediction.social_force_model import Walkers
from controllers.safety.emergency_braking import GRAVITY

NUMBER = "002"
FRICTION = 0.8
GRIP = FRICTION * GRAVITY
DEAD_TIME, RAMP = 0.1, 0.2
"""Dead time and ramp of the brake [s]."""
LANE_WIDTH = 3.1
OWN = 0.5 * LANE_WIDTH
"""Centre line of the ego's lane from the right edge: the offset of the paper's AEB, which only brakes [m]."""
WALKER = 2.4
"""Start of the pedestrian, measured from the right edge [m]."""
PACE = 1.25
"""Walking speed of the pedestrian [m/s]."""
START = f"the pedestrian's start, {WALKER:g} m from the edge and walking to the right, which is not given"
SEED = 1
BUDGET = Budget(population=32, generations=25)


@dataclass(frozen=True, slots=True)
class Row:
    """One row of Table 2."""

    offset: float
    """y_final [m]."""
    speed_kmh: float
    """v_s"""
    curvature: float
    """cost_c"""
    distance: float
    """cost_d"""
    entropy: float
    """cost_s"""


@dataclass(frozen=True, slots=True)
class Situation:
    """One of the situations A(1) to A(4), and the result of the paper's method."""

    name: str
    distance: float
    """Distance to the pedestrian [m]."""
    speed_kmh: float
    found: Row
    brake: Row
    """Result of AEB."""

    @property
    def speed(self) -> float:
        """Return the speed at the start [m/s]."""
        return self.speed_kmh / 3.6

    @property
    def braking(self) -> TrapezoidalBraking:
        """Return the braking with which AEB stops."""
        return self.braking_to(0.0)

    def braking_to(self, final_speed: float) -> TrapezoidalBraking:
        """Return the trapezoidal braking to a final speed [m/s]."""
        return TrapezoidalBraking(self.speed, final_speed, GRIP, DEAD_TIME, RAMP)

    @property
    def gap(self) -> float:
        """Return the gap that AEB leaves if it brakes at once; negative for a contact [m]."""
        return self.distance - self.braking.distance


STOPS = Row(1.55, 0.0, 0.0, 0.045, 0.0)
HITS = replace(STOPS, distance=float("inf"))
SITUATIONS = (
    Situation("A1", 20.0, 40.0, Row(1.97, 14.72, 0.065, 0.069, 0.548), STOPS),
    Situation("A2", 20.0, 50.0, Row(1.83, 11.35, 0.025, 0.057, 0.732), STOPS),
    Situation("A3", 10.0, 40.0, Row(2.98, 16.25, 0.547, 0.274, 0.365), HITS),
    Situation("A4", 10.0, 50.0, Row(2.83, 1.63, 0.349, 0.0923, 0.236), HITS),
)

RULES = Rules(
    full_braking=True, within_friction=False, margin=0.0, edge_margin=0.0, horizon=6.0, step=0.05, walks=32
)
"""Rules of the paper: full braking, without regard to the tyres' friction."""


def problem(situation: Situation, start: float = WALKER, way: float = -1.0) -> Scene:
    """Return the situation as a planning problem; the car is the paper's disc.

    Parameters
    ----------
    situation : one of the four situations
    start : start of the pedestrian from the right edge [m]
    way : +1 if the pedestrian walks to the left, −1 to the right
    """
    return Scene(
        shape=Shape(Body(), disc_radius=1.6),
        limits=CarLimits(deceleration=GRIP, curvature=1.0, friction=FRICTION, steering_rate=float("inf")),
        start=PathStart(OWN),
        speed=situation.speed,
        fastest=situation.speed,
        acceleration=0.0,
        length=situation.distance,
        braking_distance=situation.distance,
        right=-np.inf,
        left=np.inf,
        people=Walkers(
            np.array([situation.distance]), np.array([start]), np.zeros(1), np.array([way * PACE])
        ),
    )


def verdict(scene: Scene, rules: Rules, offset: FloatArray, speed: FloatArray, seed: int = SEED) -> Verdict:
    """Return the verdict on candidates."""
    noise = np.random.default_rng(seed).standard_normal((len(rules.times), len(scene.people.x), rules.walks))
    return judge(scene, rules, offset, speed, noise)


def at_the_table(
    situation: Situation,
    mode: EntropyMode = EntropyMode.PAPER,
    when: EntropyAt = EntropyAt.LARGEST,
) -> Verdict:
    """Return the verdict on the candidate that the paper's method found."""
    row = situation.found
    return verdict(
        problem(situation),
        replace(RULES, entropy=mode, entropy_at=when),
        np.array([row.offset]),
        np.array([row.speed_kmh / 3.6]),
    )


def grid(situation: Situation) -> tuple[FloatArray, FloatArray]:
    """Return the offsets and final speeds of 12 · 14 candidates [m, m/s]."""
    offsets, speeds = np.meshgrid(np.linspace(0.0, 3.5, 12), np.linspace(0.0, situation.speed, 14))
    return offsets.ravel(), speeds.ravel()


def possible(situation: Situation, start: float, way: float, *, within_friction: bool = False) -> int:
    """Return how many candidates of the grid touch nobody and, if asked, stay within the friction limit."""
    scene, rules = problem(situation, start, way), replace(RULES, within_friction=within_friction, step=0.02)
    nobody_random = np.zeros((len(rules.times), 0, 1))
    return int(judge(scene, rules, *grid(situation), nobody_random).feasible.sum())


def nearest(situation: Situation, start: FloatArray, way: float, *, reacts: bool = True) -> FloatArray:
    """Return how near the table's candidate, or a car that does not react, comes to each pedestrian [m].

    Parameters
    ----------
    start : starts of pedestrians, each alone on the road, from the right edge, shape (n,) [m]
    way : +1 walks to the left, −1 to the right
    reacts : whether the car drives the table's candidate
    """
    row = situation.found
    offset, speed = (row.offset, row.speed_kmh / 3.6) if reacts else (OWN, situation.speed)
    rules = replace(RULES, step=0.02)
    nobody = np.zeros((len(rules.times), 0, 1))
    moving = judge(problem(situation), rules, np.array([offset]), np.array([speed]), nobody).motions
    walkers = start[:, None] + way * PACE * moving.times
    return np.asarray(np.hypot(moving.along - situation.distance, moving.across - walkers).min(axis=1))


def chosen(situation: Situation, mode: EntropyMode) -> tuple[Front, Verdict, int] | None:
    """Return the front that NSGA-II finds, its verdict and the index of the chosen candidate."""
    lower, upper = np.array([0.0, 0.0]), np.array([3.5, situation.speed])
    rules = replace(RULES, entropy=mode)
    return choose(problem(situation), rules, BUDGET, lower, upper, np.zeros((0, 2)), SEED)
