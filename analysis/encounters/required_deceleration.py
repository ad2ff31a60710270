"""The deceleration that an ego needs at each sample, with or without a reaction time."""

from __future__ import annotations

import numpy as np

from analysis.arrays import FloatArray
from analysis.encounters.case import Case
from analysis.encounters.prediction import required_deceleration


def drac(case: Case, reaction_s: float) -> FloatArray:
    """Return the deceleration needed at each sample; nan where the pedestrian does not count [m/s^2].

    For crossing pedestrians it is what ``required_deceleration`` returns; for those moving along the ego's
    direction, ``closing speed^2 / (2 gap)``. The ego keeps its speed until the reaction time is over.
    """
    samples, area = case.samples, case.predicted
    speed = samples.ego_speed
    with np.errstate(invalid="ignore"):
        crossing = required_deceleration(
            speed, area.distance_in - speed * reaction_s, area.person_out - reaction_s
        )
        # An ego already across the path of a pedestrian who is outside goes first and need not brake.
        first = (area.ego_out < area.person_in) | ((area.distance_in <= 0.0) & (area.person_in > 0.0))
    out_of_it = np.isnan(area.person_in) | (area.distance_out <= 0.0) | first
    crossing = np.where(out_of_it, 0.0, crossing)
    gap = samples.x - samples.half_length - samples.radius
    closing = -samples.relative_x_speed
    after = gap - closing * reaction_s
    follows = (np.abs(samples.y) <= samples.half_width + samples.radius) & (samples.x > 0.0) & (closing > 0.0)
    divisor = np.where(after > 0.0, after, 1.0)
    following = np.where(after > 0.0, closing**2 / (2.0 * divisor), np.inf)
    along = np.where(follows, following, 0.0)
    return np.where(samples.exposed, np.where(area.longitudinal, along, crossing), np.nan)
