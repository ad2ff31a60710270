"""Contacts between an ego's rectangle and a pedestrian's disc, exact between samples."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.encounters.samples import Samples
from analysis.geometry import closest_approach, time_to_contact


@dataclass(frozen=True, slots=True)
class Contact:
    """One contact; touches closer in time than the separation count as one."""

    encounter: int
    time: float
    ego_speed: float
    """At first touch [m/s]."""
    relative_speed: float
    """Length of the velocity of one relative to the other at first touch [m/s]."""
    x: float
    """Disc's centre in the frame of the rectangle at first touch [m]."""
    y: float
    standing: bool
    """Whether the ego stood, so that the pedestrian walked into it."""
    began: float
    """First touch of all; earlier than ``time`` if the ego still stood then [s]."""
    ended: float
    """Last touch [s]."""

    def side(self, half_length: float, half_width: float) -> str:
        """Return the side of the rectangle that was touched: front, rear, left or right."""
        along, across = abs(self.x) - half_length, abs(self.y) - half_width
        if along >= across:
            return "front" if self.x > 0.0 else "rear"
        return "left" if self.y > 0.0 else "right"


@dataclass(frozen=True, slots=True)
class Approach:
    """Smallest clearance of each encounter, exact between samples [m], and its time [s]."""

    distance: FloatArray
    time: FloatArray


def find_contacts(samples: Samples, separation_s: float, standing_speed: float) -> list[Contact]:
    """Return all contacts in the order of encounters and time.

    Between two samples the disc's centre moves straight in the frame of the rectangle, so that no contact is
    missed, however fast the ego drives or turns.
    """
    if len(samples) == 0:
        return []
    index, shares = _touches(samples)
    contacts: list[Contact] = []
    touches: list[Contact] = []
    for i, share in zip(index.tolist(), shares.tolist(), strict=True):
        touch = _touch(samples, i, share, standing_speed)
        before = touches[-1] if touches else None
        if before is not None and (
            before.encounter != touch.encounter or touch.time - before.time >= separation_s
        ):
            contacts.append(_merged(touches))
            touches = []
        touches.append(touch)
    if touches:
        contacts.append(_merged(touches))
    return contacts


def _merged(touches: list[Contact]) -> Contact:
    """Return the first touch with a moving ego, or the first of all if the ego stood throughout."""
    chosen = next((touch for touch in touches if not touch.standing), touches[0])
    return replace(chosen, began=touches[0].time, ended=touches[-1].time)


def _touch(samples: Samples, i: int, share: float, standing_speed: float) -> Contact:
    same = i + 1 < len(samples) and samples.owner[i + 1] == samples.owner[i]
    j = i + 1 if same else i
    speed = _between(samples.ego_speed, i, j, share)
    relative = np.hypot(
        _between(samples.x_speed, i, j, share) - speed, _between(samples.y_speed, i, j, share)
    )
    return Contact(
        encounter=int(samples.owner[i]),
        time=_between(samples.time, i, j, share),
        ego_speed=speed,
        relative_speed=float(relative),
        x=_between(samples.x, i, j, share),
        y=_between(samples.y, i, j, share),
        standing=speed <= standing_speed,
        began=_between(samples.time, i, j, share),
        ended=_between(samples.time, i, j, share),
    )


def _between(values: FloatArray, i: int, j: int, share: float) -> float:
    return float(values[i] + share * (values[j] - values[i]))


def _touches(
    samples: Samples,
) -> tuple[IntArray, FloatArray]:
    """Return the samples before whose next one a contact begins, and the share of the step until then."""
    jump = _jump(samples)
    near = np.flatnonzero(samples.clearance <= jump)
    i, j = near, _next(samples)[near]
    share = time_to_contact(
        samples.x[i],
        samples.y[i],
        samples.x[j] - samples.x[i],
        samples.y[j] - samples.y[i],
        samples.half_length[i],
        samples.half_width[i],
        samples.radius[i],
    )
    hit = share <= 1.0
    return near[hit], share[hit]


def _next(samples: Samples) -> IntArray:
    """Return the next sample of the same encounter; at its end, the sample itself."""
    index = np.arange(len(samples))
    index[:-1] += samples.same_as_next
    return index


def _jump(samples: Samples) -> FloatArray:
    j = _next(samples)
    return np.asarray(np.hypot(samples.x[j] - samples.x, samples.y[j] - samples.y))


def closest_approaches(samples: Samples, allowed: BoolArray | None = None) -> Approach:
    """Return each encounter's smallest clearance over the allowed samples, exact between them."""
    if len(samples) == 0:
        return Approach(np.zeros(0), np.zeros(0))
    j = _next(samples)
    usable = np.ones(len(samples), dtype=np.bool_) if allowed is None else allowed
    both = usable & usable[j]
    clear = np.where(usable, samples.clearance, np.inf)
    low, _ = samples.smallest(clear)
    # Only a segment that may come below the smallest sampled clearance needs the exact check.
    reach = np.where(both, np.minimum(clear, clear[j]) - 0.5 * _jump(samples), np.inf)
    check = np.flatnonzero(both & (reach <= low[samples.owner]))
    distance = clear.copy()
    when = samples.time.copy()
    k = j[check]
    least, share = closest_approach(
        samples.x[check],
        samples.y[check],
        samples.x[k] - samples.x[check],
        samples.y[k] - samples.y[check],
        samples.half_length[check],
        samples.half_width[check],
        samples.radius[check],
        1.0,
    )
    distance[check] = np.minimum(least, distance[check])
    when[check] = samples.time[check] + share * (samples.time[k] - samples.time[check])
    best, at = samples.smallest(distance)
    time = np.where(np.isfinite(best), when[np.minimum(at, len(samples) - 1)], np.nan)
    return Approach(np.where(np.isfinite(best), best, np.nan), time)
