"""How much the potential-field paper's claims depend on the gains and on the pedestrian's direction."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.potential_field.field import Field, Gains, standing
from controllers.prediction.direction_choice import ANGLES, DirectionModel, Errand
from studies.papers.potential_field.scenes import (
    CENTRE,
    EDGE,
    FIXED_AXIS,
    SAFE,
    SCENES,
    Scene,
    Track,
    field_of,
    tracks,
)

CENTRE_GAINS = (0.02, 0.05, 0.1, 0.2)
OBSTACLE_GAINS = (0.1, 0.3, 0.6)
EDGE_GAINS = (0.01, 0.02, 0.05)
LINE_GAINS = (0.01, 0.02, 0.05)
LINE_WIDTH = 0.5
EXAMPLE: Final = Errand(8.0, goal_along=-5.0, goal_beyond=1.0)
"""The paper's example: from (50, 4) to (45, −5) over 8 m of road."""
EXAMPLE_START = (50.0, 4.0)


@dataclass(frozen=True, slots=True)
class Orders:
    """Which of the paper's claims hold for each gain set; arrays of shape (sets,)."""

    curvature: dict[str, BoolArray]
    """Whether the curvature is smaller with the variable axis (in scene 3 larger), by scene."""
    begins: BoolArray
    """Whether avoidance begins earlier with the variable axis (in scene 3 later) in all four scenes."""
    left: BoolArray
    """Whether both axes pass on the left in scene 3 and on the right in the others."""
    untouched: BoolArray
    """Whether nobody is touched in any scene with the variable axis."""
    on_road: BoolArray
    """Whether the body stays on the road in all scenes with the variable axis."""

    @property
    def everything(self) -> BoolArray:
        """Whether all claims hold."""
        orders = np.all(list(self.curvature.values()), axis=0)
        return np.asarray(orders & self.begins & self.left & self.untouched & self.on_road)

    @property
    def count(self) -> int:
        """Number of gain sets."""
        return len(self.begins)


def gain_grid() -> Gains:
    """Return 108 untuned gain sets."""
    sets = np.array(list(itertools.product(CENTRE_GAINS, OBSTACLE_GAINS, EDGE_GAINS, LINE_GAINS)))
    return Gains(1.0, sets[:, 0], sets[:, 1], sets[:, 2], sets[:, 3], np.full(len(sets), LINE_WIDTH))


def orders(*, moving: bool) -> Orders:
    """Return which claims hold for each gain set.

    Parameters
    ----------
    moving : whether the obstacle moves with the pedestrian; otherwise it stays at the conflict point
    """
    gains = gain_grid()
    count = len(np.asarray(gains.centre))
    fixed, variable = (
        {
            scene.name: tracks(scene, field_of(scene, axis(scene), gains, moving=moving), count)
            for scene in SCENES
        }
        for axis in (lambda scene: FIXED_AXIS, lambda scene: scene.long_axis)
    )

    def smaller(name: str, value: Callable[[Track], float]) -> BoolArray:
        """Return for which gain sets the variable axis has the smaller value (in scene 3, the larger)."""
        there = np.array([value(track) for track in variable[name]])
        here = np.array([value(track) for track in fixed[name]])
        return there > here if name == "3" else there < here

    def always(holds: Callable[[Track], bool]) -> BoolArray:
        found = [[holds(track) for track in variable[scene.name]] for scene in SCENES]
        return np.asarray(np.array(found).all(axis=0))

    def sided(found: dict[str, list[Track]]) -> BoolArray:
        wanted = {scene.name: "left" if scene.name == "3" else "right" for scene in SCENES}
        sides = [[track.side == wanted[name] for track in found[name]] for name in wanted]
        return np.asarray(np.array(sides).all(axis=0))

    begins = [smaller(scene.name, lambda track: track.begins) for scene in SCENES]
    return Orders(
        {scene.name: smaller(scene.name, lambda track: track.highest_curvature) for scene in SCENES},
        np.all(begins, axis=0),
        sided(fixed) & sided(variable),
        always(lambda track: track.clearance > 0.0),
        always(lambda track: track.beyond_edge <= 0.0),
    )


@dataclass(frozen=True, slots=True)
class Directions:
    """Results for a pedestrian who walks in each of the 121 directions."""

    probabilities: FloatArray
    """Probabilities of the directions in the paper's example."""
    clearance: FloatArray
    """Smallest distance between the bodies [m]."""
    beyond_edge: FloatArray
    """Largest distance by which the body extends beyond the road [m]."""

    @property
    def touched(self) -> float:
        """Probability of a contact."""
        return float(self.probabilities[self.clearance < 0.0].sum())

    @property
    def off_road(self) -> float:
        """Probability that the body extends beyond the road."""
        return float(self.probabilities[self.beyond_edge > 0.0].sum())


def directions(*, variable: bool) -> Directions:
    """Return the results of the tuned field in the paper's example, for every direction of walking.

    As in the four scenes, the direction is known from the first step, and the conflict point follows from it.
    """
    scenes = [Scene("example", *EXAMPLE_START, float(angle)) for angle in ANGLES]
    axes = [scene.long_axis if variable else FIXED_AXIS for scene in scenes]
    places = np.array([scene.conflict for scene in scenes])
    obstacles = standing(
        places[:, :1], places[:, 1:], np.array(axes)[:, None], np.full((len(scenes), 1), SAFE)
    )
    shape = Field(-EDGE, EDGE, CENTRE, np.zeros(1), obstacles)
    paths = tracks(scenes[0], shape, len(scenes))
    seen = [
        Track(scene, path.times, path.x, path.y, path.heading, path.bends)
        for scene, path in zip(scenes, paths, strict=True)
    ]
    return Directions(
        DirectionModel().probabilities(EXAMPLE),
        np.array([track.clearance for track in seen]),
        np.array([track.beyond_edge for track in seen]),
    )
