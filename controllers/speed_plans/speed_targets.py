"""Obstacles that speed plans are made for: leaders, and places to stop for pedestrians.

A pedestrian whose path crosses the ego's counts as an obstacle that stands at the stop line, or at the
pedestrian if there is no line, until they have left the ego's path. Pedestrians who enter it only after the
ego has passed are not obstacles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts import path_conflicts
from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch
from controllers.conflicts.path_conflicts import STRAIGHT_ON, Conflicts
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.leaders import neighbours_ahead
from controllers.interface import Perception
from controllers.perception import Many, only
from controllers.prediction.forecast import Forecast, Predictor

FORECAST_SPACING = 0.25
"""Time step of the predictions [s]."""
PAST_THE_LINE = 0.3
"""A stop line overrun by no more than this is still the place to stop at [m]."""
COMMITTED, RESUMED = 0.3, 2.0
"""Shares of the time margin that are enough to continue ahead of a pedestrian, and to go ahead after all of a
pedestrian to whom the ego was yielding."""
CAREFUL_BEFORE = 5.0
"""The ego passes pedestrians who let it go first slowly from this distance before them [m]."""


@dataclass(frozen=True, slots=True)
class SpeedTarget:
    """Something ahead that the ego must not reach, or must follow."""

    key: str
    """Identifies the target for as long as it is there; empty for nothing."""
    name: str
    """Name of the vehicle or pedestrian; of several, the one who leaves last."""
    gap: float
    """Distance from the ego's front bumper [m]."""
    speed: float = 0.0
    """[m/s]"""
    acceleration: float = 0.0
    """[m/s^2]"""
    standoff: float = 0.0
    """Distance to keep to it at standstill [m]."""
    leaves: float = float("inf")
    """Time until it will be gone [s]."""
    body_gap: float = float("inf")
    """Distance from the front bumper to the pedestrian for whom the stop is; inf for a vehicle [m]."""


FREE = SpeedTarget("", "", float("inf"))
"""Nothing ahead."""


@dataclass(frozen=True, slots=True)
class CrossingRule:
    """When to go ahead of a pedestrian and where to stop for one."""

    standoff: float
    """Distance to a pedestrian away from a crossing [m]."""
    side_margin: float
    """Distance by which a pedestrian's disc is enlarged across the ego's way [m]."""
    time_margin: float
    """Time between the ego being past and a pedestrian coming into its way [s]."""
    clearance: float = 1.0
    """Distance behind the ego at which a pedestrian may cross [m]."""
    horizon: float = 8.0
    """Pedestrians who come into the way later than this do not matter yet [s]."""
    assume: PedestrianAssumptions = field(default_factory=PedestrianAssumptions)


@dataclass(frozen=True, slots=True)
class Yielding:
    """Whom the ego lets go first, and whom it passes ahead of."""

    targets: tuple[SpeedTarget, ...]
    names: frozenset[str]
    """Names of all pedestrians whom the targets are for."""
    passing: str
    """Passing order, ``behind=p1|p2 ahead=p3``; empty with nobody in conflict."""
    along: FloatArray
    """Positions of all pedestrians in conflict, ``across`` likewise [m]."""
    across: FloatArray


def leaders(
    perception: Perception, target_lane: int, style: DrivingStyle, leaving: bool
) -> tuple[list[SpeedTarget], frozenset[str]]:
    """Return the vehicles ahead as targets, and the names of standing vehicles that the ego drives past.

    Parameters
    ----------
    perception : what the ego knows
    target_lane : ``Lane.number`` to end in; its leader counts as well as the leader in the ego's lane
    style : driving style, for the distances kept to standing vehicles
    leaving : whether the ego waits for a chance to leave its lane
    """
    ahead, passed = neighbours_ahead(perception, target_lane, style, leaving)
    found = [
        SpeedTarget(one.name, one.name, one.gap, one.speed, one.acceleration, one.standstill_gap)
        for one in ahead
    ]
    return found, frozenset(one.name for one in passed)


class PedestrianTargets:
    """Decides whom to let go first; it remembers its decisions, so each ego needs its own."""

    def __init__(self, rule: CrossingRule, predictor: Predictor | None = None) -> None:
        self.rule = rule
        self._predictor = predictor
        self._watch = Watch()
        self._ahead: dict[str, bool] = {}

    def find(self, perception: Perception, offset: float, time_past: Callable[[float], float]) -> Yielding:
        """Return where to stop, and for whom.

        Parameters
        ----------
        perception : what the ego knows
        offset : across coordinate of the target lane [m]
        time_past : time at which the ego will have driven a distance, by its present plan [s]
        """
        ego, rule = perception.ego, self.rule
        half = 0.5 * ego.body.width
        band = (min(ego.across, offset) - half, max(ego.across, offset) + half)
        conflicts = path_conflicts.find(
            perception,
            self._watch,
            band,
            rule.side_margin,
            rule.horizon,
            rule.assume,
            self._forecast(perception),
        )
        ahead = [self._goes_ahead(perception, conflicts, i, time_past) for i in range(len(conflicts))]
        self._ahead = dict(zip(conflicts.names, ahead, strict=True))
        yielded = [i for i, first in enumerate(ahead) if not first and not _beside(perception, conflicts, i)]
        targets = _by_place([_target(perception, conflicts, i, rule) for i in yielded])
        names = ["|".join(n for n, first in self._ahead.items() if first is side) for side in (False, True)]
        return Yielding(
            tuple(targets),
            frozenset(conflicts.names[i] for i in yielded),
            f"behind={names[0]} ahead={names[1]}" if len(conflicts) else "",
            conflicts.along,
            conflicts.across,
        )

    def careful_speed(self, perception: Perception, deceleration: float) -> float:
        """Return how fast to drive past people who let the ego go first; inf if there are none [m/s]."""
        assume, front = self.rule.assume, perception.ego.body.front
        places = self._watch.carefully_past(perception, assume)
        room = np.maximum(places[places > 0.0] - CAREFUL_BEFORE - front, 0.0)
        allowed = np.sqrt(assume.careful_speed**2 + 2.0 * deceleration * room)
        return float(allowed.min(initial=np.inf))

    def _forecast(self, perception: Perception) -> Forecast | None:
        if self._predictor is None:
            return None
        count = int(np.ceil(self.rule.horizon / FORECAST_SPACING))
        return self._predictor.predict(perception, np.linspace(0.0, count * FORECAST_SPACING, count + 1))

    def _goes_ahead(
        self,
        perception: Perception,
        conflicts: Conflicts,
        i: int,
        time_past: Callable[[float], float],
    ) -> bool:
        """Return whether the ego is past before a pedestrian comes into its way."""
        rule, body = self.rule, perception.ego.body
        enter = float(conflicts.enter[i])
        there = float(conflicts.along_at(np.array([enter]))[i, 0])
        beyond = there + float(conflicts.radius[i]) + rule.clearance + body.rear_overhang
        before = self._ahead.get(conflicts.names[i])
        share = 1.0 if before is None else COMMITTED if before else RESUMED
        return enter > 0.0 and time_past(beyond) + share * rule.time_margin < enter


def without(perception: Perception, names: frozenset[str]) -> Perception:
    """Return the perception without the pedestrians and vehicles of these names."""
    return replace(
        perception,
        pedestrians=_others(perception.pedestrians, names),
        vehicles=_others(perception.vehicles, names),
    )


def _others(many: Many, names: frozenset[str]) -> Many:
    kept = [i for i, name in enumerate(many.names) if name not in names]
    return many if len(kept) == len(many.names) else only(many, kept)


def _beside(perception: Perception, conflicts: Conflicts, i: int) -> bool:
    """Return whether a pedestrian is beside the body and behind its front, where stopping would not help."""
    ego = perception.ego
    off = abs(float(conflicts.across[i]) - ego.across) - 0.5 * ego.body.width
    radius = float(conflicts.radius[i])
    return off > radius and float(conflicts.along[i]) + radius < ego.body.front


def _target(perception: Perception, conflicts: Conflicts, i: int, rule: CrossingRule) -> SpeedTarget:
    """Return where to stop for one pedestrian."""
    front = perception.ego.body.front
    line, name = float(conflicts.stop_line[i]), conflicts.names[i]
    people, index = perception.pedestrians, int(conflicts.index[i])
    enter, leave = float(conflicts.enter[i]), float(conflicts.leave[i])
    there = conflicts.along_at(np.array([enter, min(leave, enter + STRAIGHT_ON)]))[i]
    face = float(there.min() - conflicts.radius[i])
    body_gap = max(face - front, 0.0)
    # The time at which people leave who have not begun to cross, or who stand, cannot be relied on.
    walks = abs(float(people.across_speed[index])) > rule.assume.standing_below
    leaves = leave if walks and not people.waiting[index] else np.inf
    if front <= line + PAST_THE_LINE and line <= face:
        key = f"crossing {perception.road.crossings[int(people.crossing[index])].name}"
        return SpeedTarget(key, name, max(line - front, 0.0), leaves=leaves, body_gap=body_gap)
    return SpeedTarget(f"pedestrian {name}", name, body_gap, 0.0, 0.0, rule.standoff, leaves, body_gap)


def _by_place(targets: list[SpeedTarget]) -> list[SpeedTarget]:
    """Return one target for each place, for the pedestrian who leaves last, with the smallest gaps."""
    found: dict[str, SpeedTarget] = {}
    for one in targets:
        other = found.get(one.key)
        if other is None:
            found[one.key] = one
            continue
        last = one if one.leaves > other.leaves else other
        found[one.key] = SpeedTarget(
            one.key,
            last.name,
            min(one.gap, other.gap),
            standoff=last.standoff,
            leaves=last.leaves,
            body_gap=min(one.body_gap, other.body_gap),
        )
    return list(found.values())
