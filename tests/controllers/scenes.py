"""The scenes of the contract, where tests look for them."""

from cosim.conformance.scenes import (
    FRONT,
    LANE_WIDTH,
    Car,
    Walker,
    bend,
    ego,
    golden,
    keeps,
    lanes_that_follow,
    perception,
    straight_road,
    vehicles,
    zebra,
)

__all__ = [
    "FRONT",
    "LANE_WIDTH",
    "Car",
    "Walker",
    "bend",
    "ego",
    "golden",
    "keeps",
    "lanes_that_follow",
    "perception",
    "straight_road",
    "vehicles",
    "zebra",
]
