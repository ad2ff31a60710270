"""A hybrid controller of four modes: drives on, yields, goes first or brakes hard, by the gap people accept.

A filter of a driver blind to pedestrians. Along: pedestrians who will take the gap before the ego are let
pass with an even braking; before those who will refuse it the ego goes on; whoever steps out too late is
braked for. Across: lane keeping, and lane changes for the route.
"""

from __future__ import annotations

from controllers.driving.driving_style import DrivingStyle
from controllers.interface import Controller
from controllers.settings import ControllerSettings, NotNegative, Positive
from controllers.yielding.facing import PathWatch
from controllers.yielding.filtered_driver import BlindDriver, FilteredDriver
from controllers.yielding.gap_modes import GapFilter, GapRule


class Settings(ControllerSettings):
    """What can be set.

    Notes
    -----
    After the hybrid controller of [Kapania2019]_, of which only the abstract and the beginning were at hand:
    four modes, and pedestrians who accept gaps, are its; the laws of the modes are our reading. The critical
    gap is that of [HCM2010]_ with its values of walking speed and start-up time.
    """

    walking_speed_mps: Positive = 1.07
    """S_p of the critical gap, 3.5 ft/s."""
    start_up_s: NotNegative = 3.0
    """t_s of the critical gap."""
    comfortable_braking_mps2: Positive = 2.0
    """The most that yielding brakes."""
    hardest_braking_mps2: Positive = 8.0
    """The most in mode hard brake."""
    pass_acceleration_mps2: NotNegative = 1.0
    """The most in mode pass."""
    attention_m: Positive = 60.0
    """Pedestrians further ahead do not matter."""
    side_margin_m: NotNegative = 0.6
    """What a pedestrian's disc is grown by across the way."""
    standoff_m: NotNegative = 1.5
    """Distance to a pedestrian away from a crossing that is left after a stop."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    rule = GapRule(
        settings.walking_speed_mps,
        settings.start_up_s,
        settings.comfortable_braking_mps2,
        settings.hardest_braking_mps2,
        settings.pass_acceleration_mps2,
        settings.attention_m,
    )
    driver = BlindDriver(DrivingStyle(headway=settings.headway_s))
    watch = PathWatch(settings.side_margin_m, settings.standoff_m)
    return FilteredDriver(driver, GapFilter(rule), watch)
