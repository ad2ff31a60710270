"""Measurements of a recorded run for a protocol: impact, braking, and whether the ego stopped."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.encounters.case import Case, prepare
from analysis.encounters.contacts import Contact
from analysis.encounters.finding import come_within
from analysis.metrics import preventable_r157
from analysis.recording.reading import read_run


@dataclass(frozen=True, slots=True)
class Impact:
    """First contact while the ego moves."""

    time: float
    """Time of the contact [s]."""
    speed: float
    """Speed of the ego relative to the pedestrian, along the ego [m/s]."""
    ego_speed: float
    across: float
    """Lateral distance of the pedestrian's centre from the ego's, positive to the left [m]."""
    ego_width: float
    side: str
    """Side of the ego that was hit: front, rear, left or right."""

    def overlap(self, from_left: bool) -> float:
        """Return the point of impact as a share of the ego's width, from the pedestrian's side."""
        share = 0.5 + self.across / self.ego_width
        return 1.0 - share if from_left else share


@dataclass(frozen=True, slots=True)
class Measured:
    """Measurements of one test."""

    impact: Impact | None
    after_stop: bool
    """Whether the ego had stopped before the impact and gone on."""
    stopped: bool
    """Whether the ego stood at any time."""
    largest_deceleration: float
    """Largest deceleration of the ego [m/s^2]."""
    preventable: bool | None
    """Whether it was preventable; ``None`` if undefined, as in analysis/metrics/preventable_r157.py."""
    near: bool = True
    """Whether the ego came within the range of an encounter of a pedestrian."""
    walked: bool = True
    """Whether a pedestrian walked at any time; those who cross set off when the ego is near enough."""


def measure(folder: Path) -> Measured:
    """Return the measurements of a recorded run.

    Raises
    ------
    RecordingError
        If the run cannot be read.
    """
    case = prepare(read_run(folder))
    contact = min(case.collisions(), key=lambda one: one.time, default=None)
    standing = case.thresholds.standing_speed_mps
    egos = case.run.egos.numbers
    stops = egos["time_s"][egos["speed_mps"] <= standing]
    return Measured(
        impact=None if contact is None else _impact(case, contact),
        after_stop=contact is not None and bool(np.any(stops < contact.time)),
        stopped=len(stops) > 0,
        largest_deceleration=float(case.steps.deceleration.max(initial=0.0)),
        preventable=_preventable(case),
        near=any(
            come_within(ego, person, case.thresholds.encounter_range_m)
            for ego in case.egos
            for person in case.persons
        ),
        walked=any(
            (person.speed > case.thresholds.pedestrian_standing_speed_mps).any() for person in case.persons
        ),
    )


def _impact(case: Case, contact: Contact) -> Impact:
    samples = case.samples
    own = samples.owner == contact.encounter
    along = float(np.interp(contact.time, samples.time[own], samples.x_speed[own]))
    half_length, half_width = (float(sizes[own][0]) for sizes in (samples.half_length, samples.half_width))
    return Impact(
        contact.time,
        contact.ego_speed - along,
        contact.ego_speed,
        contact.y,
        2.0 * half_width,
        contact.side(half_length, half_width),
    )


def _preventable(case: Case) -> bool | None:
    """Return whether the first contact was preventable; without one, an encounter's first defined value."""
    first = min(case.collisions(), key=lambda one: one.time, default=None)
    if first is not None:
        return case.replays[first].prevented
    values = preventable_r157.compute(case)["preventable_r157"]
    defined = values[~np.isnan(values)] if len(values) else values
    return bool(defined[0]) if len(defined) else None
