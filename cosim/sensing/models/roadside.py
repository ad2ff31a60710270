"""Roadside units tell the ego by radio; it has no sensor of its own for pedestrians."""

from __future__ import annotations

from cosim.sensing.interface import Sensor, Site
from cosim.sensing.radio import Radio, RadioSettings


class Model(RadioSettings):
    """The parameters, and the receivers built from them."""

    @property
    def exact(self) -> bool:
        """Always false: egos have to be told."""
        return False

    def sensor(self, site: Site, seed: int, ego: str) -> Sensor:
        """Return the receiver of one ego."""
        return Radio(self, site, seed, ego)
