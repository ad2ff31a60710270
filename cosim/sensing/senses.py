"""The sensors of all egos of a run, and the record of what they knew."""

from __future__ import annotations

import numpy as np

from cosim.sensing.interface import Belief, Scene, Sensed, Sensing, Sensor, Site, State

_STATES = {int(state): state.name.lower() for state in State}


class Senses:
    """Queries each ego's sensor, and keeps the answers of the present instant.

    Parameters
    ----------
    sensing : the model
    site : what does not move
    seed : seed of the run

    Raises
    ------
    ValueError
        If the model's parameters do not fit the site.
    """

    def __init__(self, sensing: Sensing, site: Site, seed: int) -> None:
        self._sensing, self._site, self._seed = sensing, site, seed
        self._sensors: dict[str, Sensor] = {}
        self._now: list[Sensed] = []
        sensing.sensor(site, seed, "")  # raises here if the parameters do not fit the site

    def begin(self) -> None:
        """Begin an instant, and drop the answers of the last one."""
        self._now = []

    def look(self, scene: Scene) -> Belief:
        """Return what the scene's ego knows."""
        sensor = self._sensors.get(scene.ego)
        if sensor is None:
            sensor = self._sensors[scene.ego] = self._sensing.sensor(self._site, self._seed, scene.ego)
        belief = sensor.look(scene)
        off = belief.position - scene.position
        self._now.append(
            Sensed(
                scene.time,
                scene.ego,
                scene.names,
                belief.told,
                tuple(_STATES[state] for state in belief.state.tolist()),
                belief.age,
                np.hypot(off[:, 0], off[:, 1]),
                belief.uncertainty,
            )
        )
        return belief

    def forget(self, ego: str) -> None:
        """Remove the sensor of an ego that is gone."""
        self._sensors.pop(ego, None)

    @property
    def now(self) -> tuple[Sensed, ...]:
        """Knowledge of the egos at this instant, in the order in which they looked."""
        return tuple(self._now)
