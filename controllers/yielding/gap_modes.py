"""A hybrid controller of four modes that counts on pedestrians who accept or refuse the gap before a car."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving.following import limit_now
from controllers.yielding.facing import Answer, Facing


class Mode(StrEnum):
    """What the controller does."""

    NOMINAL = "nominal"
    """Nobody asks for anything: the driver drives."""
    YIELD = "yield"
    """Stops before the crossing, as evenly as possible."""
    PASS = "pass"
    """Goes ahead of pedestrians who will refuse the gap, at the limit: a clear sign, and soon over."""
    HARD_BRAKE = "hard_brake"
    """Somebody steps out whom an even braking does not avoid."""


@dataclass(frozen=True, slots=True)
class GapRule:
    """When which mode is taken.

    Parameters
    ----------
    walking_speed, start_up : S_p [m/s] and t_s [s] of the critical gap t_c = L / S_p + t_s
    comfortable, hardest : braking [m/s^2]
    acceleration : in mode pass [m/s^2]
    attention : distance along the road at which crossing pedestrians begin to matter [m]
    """

    walking_speed: float
    start_up: float
    comfortable: float
    hardest: float
    acceleration: float
    attention: float

    def critical_gap(self, length: FloatArray) -> FloatArray:
        """Return the gap that pedestrians accept at least, shape (n,) [s].

        Parameters
        ----------
        length : what is left to walk until they are out of the way, shape (n,) [m]

        Notes
        -----
        Eq. (19-69) of [HCM2010]_.
        """
        return np.asarray(length / self.walking_speed + self.start_up)


class GapFilter:
    """The modes of one ego.

    Parameters
    ----------
    rule : when which mode is taken
    """

    def __init__(self, rule: GapRule) -> None:
        self._rule = rule
        self._mode = Mode.NOMINAL

    def allowed(self, facing: Facing) -> Answer:
        """Return what the mode asks for; the mode is the answer's status."""
        ego, people, rule = facing.perception.ego, facing.people, self._rule
        near = np.flatnonzero((facing.gaps < rule.attention) & (people.along + people.radius > 0.0))
        if not len(near):
            self._mode = Mode.NOMINAL
            return Answer()
        first = int(near[np.argmin(facing.gaps[near])])
        name = people.names[first]
        inside = people.enter[near] <= 0.0
        accepts = self._accepts(facing, near) | inside
        stoppers = near[accepts & facing.meets(rule.start_up)[near]]
        if not len(stoppers):
            self._mode = Mode.PASS
            limit = limit_now(facing.perception.road, ego.body.front)
            faster = facing.wanted if ego.speed >= limit else max(facing.wanted, 0.0)
            return Answer(min(faster, rule.acceleration), True, name, status=_told(self._mode))
        gap = float(facing.gaps[stoppers].min())
        who = people.names[int(stoppers[np.argmin(facing.gaps[stoppers])])]
        needed = ego.speed**2 / (2.0 * max(gap, 0.1))
        hard = needed > rule.comfortable * (0.7 if self._mode is Mode.HARD_BRAKE else 1.0)
        self._mode = Mode.HARD_BRAKE if hard else Mode.YIELD
        # Of an even braking the distance left is the same at every speed; it begins when it takes half.
        begins = hard or needed > 0.5 * rule.comfortable or ego.speed < 1.0
        most = -min(needed, rule.hardest) if begins else facing.wanted
        return Answer(min(most, facing.wanted), True, who, status=_told(self._mode))

    def _accepts(
        self, facing: Facing, near: np.ndarray[tuple[int, ...], np.dtype[np.int64]]
    ) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """Say who of those near will take the gap before the ego, if it went on as it does."""
        ego, people = facing.perception.ego, facing.people
        half = 0.5 * ego.body.width + people.radius[near]
        left = np.abs(people.across[near] - ego.across) + half
        gap = np.maximum(people.along[near] - ego.body.front, 0.0) / max(ego.speed, 0.1)
        walking = np.abs(people.across_speed[near]) > 0.2
        return np.asarray((gap >= self._rule.critical_gap(left)) | (walking & (people.enter[near] < gap)))


def _told(mode: Mode) -> str:
    return "ok" if mode is Mode.NOMINAL else f"mode_{mode.value}"
