"""A hybrid controller of four modes: drives on, yields, brakes hard or gets past whoever steps out.

A filter of a driver blind to pedestrians. Along: the ego stops for pedestrians who step out, comfortably if
that is enough and hard if it is not; if it cannot stop in time, it gets past before they are there. Across:
lane keeping, and lane changes for the route.
"""

from __future__ import annotations

from typing import ClassVar

from controllers.driving.driving_style import DrivingStyle
from controllers.interface import Controller
from controllers.settings import ControllerSettings, NotNegative, Positive
from controllers.yielding.facing import PathWatch
from controllers.yielding.filtered_driver import BlindDriver, FilteredDriver
from controllers.yielding.gap_modes import GapFilter, GapRule

NO_GAP = "pedestrians who wait are left to accept their gap; the ego minds those who step out"


class Settings(ControllerSettings):
    """The parameters of the controller.

    Notes
    -----
    This follows the hybrid controller of [Kapania2019]_, with the values of the code that its authors
    published; margins and time gap are ours.
    """

    moved: ClassVar = {"start_up_s": NO_GAP, "attention_m": NO_GAP}

    comfortable_braking_mps2: Positive = 3.0
    """Braking with which yielding is planned; keeping to the plan may take harder braking."""
    hardest_braking_mps2: Positive = 9.0
    """Hardest braking in mode hard brake."""
    jerk_mps3: Positive = 1.5
    """Jerk with which braking grows and ends while yielding."""
    pass_acceleration_mps2: NotNegative = 3.0
    """Largest acceleration in mode pass."""
    gain_per_s: Positive = 2.0
    """Gain with which planned speeds are tracked."""
    walking_speed_mps: Positive = 1.5
    """Least speed that pedestrians on their way are assumed to have."""
    time_advantage_s: NotNegative = 4.0
    """The ego drives on if it arrives this much earlier than the pedestrian."""
    side_margin_m: NotNegative = 0.6
    """Distance by which a pedestrian's disc is enlarged across the ego's way."""
    standoff_m: NotNegative = 1.5
    """Distance left to a pedestrian after a stop away from a crossing."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    rule = GapRule(
        settings.comfortable_braking_mps2,
        settings.hardest_braking_mps2,
        settings.jerk_mps3,
        settings.pass_acceleration_mps2,
        settings.gain_per_s,
        settings.walking_speed_mps,
        settings.time_advantage_s,
    )
    driver = BlindDriver(DrivingStyle(headway=settings.headway_s))
    watch = PathWatch(settings.side_margin_m, settings.standoff_m)
    return FilteredDriver(driver, GapFilter(rule), watch)
