"""The ego's own sensor and roadside units; of each pedestrian it believes whichever is more certain."""

from __future__ import annotations

import numpy as np

from cosim.sensing.interface import Belief, Scene, Sensor, Site
from cosim.sensing.onboard_sensor import OnboardSensor, OnboardSettings
from cosim.sensing.radio import Radio, RadioSettings


class Model(OnboardSettings, RadioSettings):
    """The parameters of both, and the sensors built from them."""

    @property
    def exact(self) -> bool:
        """Always false: egos have to look and be told."""
        return False

    def sensor(self, site: Site, seed: int, ego: str) -> Sensor:
        """Return the two sensors of one ego as one."""
        return Both(OnboardSensor(self, site, seed, ego), Radio(self, site, seed, ego))


class Both:
    """Two sensors that work independently of each other."""

    def __init__(self, first: Sensor, second: Sensor) -> None:
        self._first, self._second = first, second

    def look(self, scene: Scene) -> Belief:
        """Return, for each pedestrian, the belief of the sensor with the smaller standard deviation."""
        first, second = self._first.look(scene), self._second.look(scene)
        better = np.where(second.told, second.uncertainty, np.inf) < np.where(
            first.told, first.uncertainty, np.inf
        )
        return Belief(
            first.told | second.told,
            np.where(better[:, None], second.position, first.position),
            np.where(better[:, None], second.velocity, first.velocity),
            np.where(better, second.uncertainty, first.uncertainty),
            np.where(better, second.age, first.age),
            np.minimum(first.state, second.state),
        )
