"""Lane choice of ``vo_mpc``: the cheapest of the lanes that the decision rules allow.

The lane choice of all other drivers is in :mod:`controllers.driving.lanes.lane_choice`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from controllers.driving.lanes.gap_acceptance import GapRule, blocker
from controllers.driving.lanes.lane_for_route import lane_for_route, leads_off_now
from controllers.driving.lanes.pedestrian_change import open_for_pedestrians
from controllers.driving.standing import STANDING
from controllers.interface import Crossing, Decision, Lane, Manoeuvre, Perception, SignalState
from controllers.velocity_obstacle import decision_rules
from controllers.velocity_obstacle.decision_rules import Rule
from controllers.velocity_obstacle.mpc.lane_manoeuvre import SETTLING, LaneManoeuvre

CostOfLane = Callable[[Lane], float]
"""Objective of driving in a lane as if the ego were in it already."""
OVER = 1.0
"""A vehicle counts as being at a waiting place up to this far before or beyond it [m]."""
WAITING_BRAKING = 4.0
"""An ego that needs more braking than this to stop with room for a change stops somewhat later [m/s^2]."""
STOPPING_LATER = 2.0
"""Braking of an ego that stops beyond its waiting place [m/s^2]."""
TIGHT_ROOM = 8.0
"""Length before the lane's end in which a change from a standstill is just possible, with the body still
askew at the end [m]."""


@dataclass(frozen=True, slots=True)
class ChangeSettings:
    """When lanes are changed, and at what cost."""

    allowed: bool
    cost: float
    """Cost of a change, in units of the objective."""
    reconsider: float
    """Interval at which the cost of other lanes is considered [s]."""
    pause: float
    """Least time between two changes that the route does not require [s]."""
    before_crossing: float
    after_crossing: float
    least_speed: float
    room: float
    """Length kept free before the end of a lane that has to be left, to steer out from a standstill [m]."""
    standstill_gap: float
    headway: float
    gaps: GapRule
    cost_near_crossing: float = np.inf
    """Cost of a change near a crossing that is made because of people on it; inf for no such change."""

    @property
    def for_pedestrians(self) -> bool:
        """Whether a change may begin near a crossing because of people on it, where it hides nobody."""
        return bool(np.isfinite(self.cost_near_crossing))


class LaneByCost:
    """Decides which lane to drive in, by decision rules and the cost of driving there; one per ego.

    Parameters
    ----------
    settings
        See :class:`ChangeSettings`.
    manoeuvre
        The lane change that may be running.
    """

    def __init__(self, settings: ChangeSettings, manoeuvre: LaneManoeuvre) -> None:
        self.settings = settings
        self.manoeuvre = manoeuvre
        self._rule = Rule.STRAIGHT  # the rule under which the running change began
        self._looked = -np.inf

    def decide(self, perception: Perception, cost: CostOfLane) -> Decision:
        """Return the decision, and begin or abort the manoeuvre accordingly."""
        self.manoeuvre.settle(perception)
        if self._gave_up(perception):
            self.manoeuvre.end(perception)
        if self.manoeuvre.running:
            return self._go_on(perception)
        required = lane_for_route(perception) if self.settings.allowed else None
        if required is not None:
            return self._for_the_route(perception, required)
        return self._by_the_rules(perception, cost)

    def _gave_up(self, perception: Perception) -> bool:
        """Return whether a change at walking pace has been aborted, or leads off the route now."""
        running = self.manoeuvre
        if running.running and running.target is not None and leads_off_now(perception, running.target):
            return True
        waited = perception.ego.time - running.started
        return (
            running.running
            and running.target == running.origin
            and waited > 2.0
            and perception.ego.speed < 1.0
        )

    def _by_the_rules(self, perception: Perception, cost: CostOfLane) -> Decision:
        s, road, gaps = self.settings, perception.road, perception.gaps
        ahead = gaps.ahead.name if gaps.ahead is not None else ""
        g_min = decision_rules.least_gap(perception.ego.speed, s.standstill_gap, s.headway)
        here = road.lane(road.reference)
        rules = [Rule.STRAIGHT]
        due = perception.ego.time - self._looked >= s.reconsider - 1e-9
        keeping: float | None = None
        full = s.cost_near_crossing if self._near_crossing(perception) else s.cost
        for lane in self._open_lanes(perception):
            side = lane.number - road.reference
            rule = decision_rules.rule(decision_rules.towards(gaps, side), g_min)
            rules.append(rule)
            if not due or rule is Rule.STRAIGHT or here is None:
                continue
            self._looked = perception.ego.time
            # By the rule LANE CHANGE, the ego's lane is too tight already: half the saving is enough.
            price = (1.0 if rule is Rule.AUTONOMOUS else 0.5) * full
            keeping = cost(here) if keeping is None else keeping
            # If staying costs less than the change itself, the other lane need not be considered.
            if keeping < price or blocker(perception, lane.number, s.gaps) is not None:
                continue
            if cost(lane) + price < keeping:
                self.manoeuvre.begin(perception, lane.number)
                self._rule = rule
                return Decision(_change(side), lane.number, rule, ahead)
        # With several adjacent lanes, the rule that leaves the most freedom describes the situation.
        freest = next(rule for rule in (Rule.AUTONOMOUS, Rule.LANE_CHANGE, Rule.STRAIGHT) if rule in rules)
        return Decision(Manoeuvre.KEEP, road.reference, freest, ahead)

    def _for_the_route(self, perception: Perception, number: int) -> Decision:
        reference = perception.road.reference
        obstacle = self._crossing_in_the_way(perception)
        obstacle = obstacle or blocker(perception, number, self.settings.gaps) or ""
        if obstacle:
            return Decision(Manoeuvre.KEEP, reference, Rule.LANE_CHANGE, obstacle)
        self.manoeuvre.begin(perception, number)
        self._rule = Rule.LANE_CHANGE
        return Decision(_change(number - reference), number, Rule.LANE_CHANGE, "lane end")

    def _go_on(self, perception: Perception) -> Decision:
        """Continue a running change, or return to the lane where it began when the gap closes."""
        running, road = self.manoeuvre, perception.road
        origin = running.origin if running.origin is not None else road.reference
        target = running.lane(perception)
        if target is None or running.target == origin:
            return Decision(Manoeuvre.ABORT_CHANGE, origin, Rule.STRAIGHT)
        side = 1 if target.number > origin else -1
        line = target.offset - side * 0.5 * target.width
        intruded = side * (perception.ego.across - line) + 0.5 * perception.ego.body.width
        # Once the ego is half a metre over the line, its neighbours have reacted: swinging back would
        # surprise them.
        if intruded < 0.5 and target.number != road.reference and road.lane(origin) is not None:
            who = blocker(perception, target.number, self.settings.gaps, begun=True)
            if who is not None:
                running.begin(perception, origin)
                return Decision(Manoeuvre.ABORT_CHANGE, origin, Rule.STRAIGHT, who)
        return Decision(_change(side), target.number, self._rule)

    def _open_lanes(self, perception: Perception) -> list[Lane]:
        """Return the adjacent lanes that a change may go to here and now, regardless of gaps."""
        s, ego, road = self.settings, perception.ego, perception.road
        pausing = ego.time - self.manoeuvre.finished < s.pause
        if not s.allowed or pausing or ego.speed < s.least_speed:
            return []
        near = self._near_crossing(perception)
        if near and not s.for_pedestrians:
            return []
        here = road.lane(road.reference)
        needed = self._length_of_change(perception)
        if here is None or _bends(perception, needed):
            return []
        worth = min(here.follows_route_for, needed + 150.0)
        return [
            lane
            for side in (1, -1)
            if (lane := road.lane(road.reference + side)) is not None
            and lane.follows_route_for >= worth
            and (not near or open_for_pedestrians(perception, lane.number, needed))
        ]

    def _length_of_change(self, perception: Perception) -> float:
        return perception.ego.speed * (self.manoeuvre.duration + SETTLING)

    def waiting_place(self, perception: Perception) -> float:
        """Return where the front bumper has to wait for a change that the route requires; inf for none [m].

        The place leaves the room that a change from a standstill takes. For a change to the right, it also
        leaves room for another vehicle: of two side by side that want each other's lane, one has to let the
        other go first. If a crossing prevents a change at the place but not beyond the crossing, the place is
        beyond it. An ego that cannot stop there any more stops beyond the place while it can still change
        from there, or may use the lane to its end.
        """
        road, ego = perception.road, perception.ego
        here, wanted = road.lane(road.reference), lane_for_route(perception)
        if here is None or not self.settings.allowed or wanted is None:
            return np.inf
        place = here.follows_route_for - self.settings.room
        behind = ego.body.length + self.settings.gaps.minimum + OVER if wanted < road.reference else 0.0
        for before in (behind, 0.0):
            at = self._clear_of_crossings(perception, place - before, here.follows_route_for - TIGHT_ROOM)
            # An ego that stands there already may be slightly beyond the place.
            if ego.speed**2 / (2.0 * WAITING_BRAKING) <= at + OVER - ego.body.front:
                return at
        later = ego.body.front + ego.speed**2 / (2.0 * STOPPING_LATER)
        tight = later > here.follows_route_for - TIGHT_ROOM
        return np.inf if tight or _crossings_near(perception, later, 0.0) else later

    def _clear_of_crossings(self, perception: Perception, place: float, last: float) -> float:
        """Return a waiting place, or one beyond the crossings near it if a change may begin there [m].

        Where crossings follow each other too closely for that, or the ``last`` place for a change comes too
        soon, the ego waits with its body on no crossing.
        """
        near = _crossings_near(perception, place, self.settings.room - 1.0)
        if not near:
            return place
        beyond = max(crossing.exit for crossing in near) + perception.ego.body.length + OVER
        if beyond <= last and not _crossings_near(perception, beyond, self.settings.room - 1.0):
            return beyond
        for crossing in sorted(near, key=lambda crossing: crossing.entry, reverse=True):
            if crossing.entry < place and crossing.exit > place - perception.ego.body.length:
                place = crossing.entry - OVER
        return place

    def _crossing_in_the_way(self, perception: Perception) -> str:
        """Return ``crossing`` if a change for the route would not end before one; empty otherwise.

        Such a change may begin nearer to a crossing than others, because a lane that ends there would
        otherwise never be left. An ego that stands where it waits for the change, as no better place follows,
        begins it if nobody is at the crossings and the light is green.
        """
        needed = max(self._length_of_change(perception), self.settings.room - 1.0)
        near = _crossings_near(perception, perception.ego.body.front, needed)
        return "crossing" if near and not self._last_place(perception, near) else ""

    def _last_place(self, perception: Perception, near: list[Crossing]) -> bool:
        """Return whether the ego stands where no better place follows, and may go over the crossings."""
        ego, road = perception.ego, perception.road
        here = road.lane(road.reference)
        if here is None or ego.speed >= STANDING:
            return False
        at_the_end = here.follows_route_for - ego.body.front < self.settings.room - 1.0
        if not at_the_end and self.waiting_place(perception) > ego.body.front + OVER:
            return False
        ahead = [signal for signal in road.signals if signal.stop_line > ego.body.front - OVER]
        if any(
            signal.state is not SignalState.GREEN and signal.stop_line - ego.body.front < self.settings.room
            for signal in ahead
        ):
            return False
        return not any(_somebody_at(perception, crossing) for crossing in near)

    def _near_crossing(self, perception: Perception) -> bool:
        """Return whether a change begun now would touch a crossing's surroundings."""
        s, body = self.settings, perception.ego.body
        before = max(s.before_crossing, self._length_of_change(perception) + 5.0)
        return any(
            crossing.exit > -s.after_crossing and crossing.entry - body.front < before
            for crossing in perception.road.crossings
        )


def _crossings_near(perception: Perception, front: float, needed: float) -> list[Crossing]:
    """Return the crossings that the body is on, or reaches in a lane change, with its front at ``front``.

    Parameters
    ----------
    perception : what the ego perceives
    front : position of the front bumper along the road [m]
    needed : length of the change [m]
    """
    rear = front - perception.ego.body.length
    return [c for c in perception.road.crossings if c.exit > rear and c.entry - front < needed]


def _somebody_at(perception: Perception, crossing: Crossing) -> bool:
    """Return whether a pedestrian is on a crossing, or waits there without a red light."""
    people = perception.pedestrians
    comes = people.on_crossing | (people.waiting & (crossing.pedestrians_have_green is not False))
    return bool((comes & (people.crossing == perception.road.crossings.index(crossing))).any())


def _bends(perception: Perception, distance: float) -> bool:
    road = perception.road
    count = int(distance / road.curvature_step) + 1
    return bool((np.abs(road.curvature[:count]) > 0.02).any())


def _change(side: int) -> Manoeuvre:
    return Manoeuvre.CHANGE_LEFT if side > 0 else Manoeuvre.CHANGE_RIGHT
