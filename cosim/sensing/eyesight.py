"""What an ego knows of its own sensing: its sensor's place, and the areas that roadside units watch."""

from __future__ import annotations

import numpy as np

from controllers.interface import Body, Eyesight
from cosim.sensing.interface import Sensing, Site
from cosim.sensing.onboard_sensor import OnboardSettings
from cosim.sensing.radio import RadioSettings, units_of

WINDSCREEN = 1.8
"""An ego without a sensor for pedestrians looks from this far behind its front bumper [m]."""


def eyesight_of(sensing: Sensing, site: Site, body: Body) -> Eyesight | None:
    """Return where an ego of that size looks from; ``None`` if it is told of everybody.

    A unit that sees over vehicles and all around watches a disc of its range. Other units are not relied on.
    A unit that falls silent is not noticed here.

    Parameters
    ----------
    sensing : the model
    site : what does not move
    body : body of the ego
    """
    if sensing.exact:
        return None
    behind, left = WINDSCREEN, 0.0
    if isinstance(sensing, OnboardSettings):
        behind, left = sensing.mount_behind_front_m, sensing.mount_left_m
    watched = np.zeros((0, 3))
    if isinstance(sensing, RadioSettings) and _sees_everything(sensing):
        places = np.array([unit.place for unit in units_of(sensing, site, 0)])
        watched = np.column_stack([places, np.full(len(places), sensing.unit_range_m)])
    return Eyesight(body.front - behind, left, watched)


def _sees_everything(units: RadioSettings) -> bool:
    return units.unit_sees_over_vehicles and units.unit_field_of_view_deg >= 360.0
