"""All pedestrians within range are known exactly."""

from __future__ import annotations

import numpy as np

from cosim.sensing.interface import Belief, Scene, Sensor, Site
from cosim.sensing.settings import Settings


class Model(Settings):
    """A model without parameters."""

    @property
    def exact(self) -> bool:
        """Always true: the world may skip the sensors."""
        return True

    def sensor(self, site: Site, seed: int, ego: str) -> Sensor:
        """Return a sensor that reports the truth."""
        return Truth()


class Truth:
    """A sensor that reports the truth."""

    def look(self, scene: Scene) -> Belief:
        """Return the true state."""
        count = len(scene.names)
        nothing = np.zeros(count)
        return Belief(
            np.ones(count, dtype=np.bool_),
            scene.position,
            scene.velocity,
            nothing,
            nothing,
            np.zeros(count, dtype=np.int64),
        )
