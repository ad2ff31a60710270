"""The ego's own sensor, which does not see through vehicles and buildings."""

from __future__ import annotations

from cosim.sensing.interface import Sensor, Site
from cosim.sensing.onboard_sensor import OnboardSensor, OnboardSettings


class Model(OnboardSettings):
    """The parameters, and the sensors built from them."""

    @property
    def exact(self) -> bool:
        """Always false: egos have to look."""
        return False

    def sensor(self, site: Site, seed: int, ego: str) -> Sensor:
        """Return the sensor of one ego."""
        return OnboardSensor(self, site, seed, ego)
