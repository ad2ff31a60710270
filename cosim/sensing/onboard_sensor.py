"""The ego's own sensor: range, field of view, occlusion, noise, misses, tracks."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from controllers.settings import NotNegative, Positive
from cosim.arrays import FloatArray
from cosim.sensing import lines_of_sight
from cosim.sensing.interface import Belief, Scene, Site
from cosim.sensing.noise import Noise
from cosim.sensing.settings import Count, FullAngle, Probability, Settings
from cosim.sensing.tracks import Tracks


class OnboardSettings(Settings):
    """What the sensor on board is like; all defaults are assumed."""

    range_m: Positive = 60.0
    """Range, to the middle of a pedestrian."""
    field_of_view_deg: FullAngle = 120.0
    """Full angle of the field of view, centred on straight ahead."""
    mount_behind_front_m: Annotated[float, Field(ge=0.0, le=20.0)] = 1.8
    """Distance from the front bumper back to the sensor behind the windscreen."""
    mount_left_m: Annotated[float, Field(ge=-2.0, le=2.0)] = 0.0
    """Distance of the sensor from the ego's centre line to the left."""
    position_noise_m: NotNegative = 0.2
    """Standard deviation along either axis."""
    velocity_noise_mps: NotNegative = 0.3
    """Standard deviation along either axis."""
    miss_probability: Probability = 0.05
    """Probability that a pedestrian in view is not detected, at each look."""
    confirm_hits: Count = 3
    """Number of detections within ``confirm_looks`` that confirms a track; others are not reported."""
    confirm_looks: Count = 5
    """Number of looks among which detections are counted."""
    hold_s: NotNegative = 1.0
    """Time for which a confirmed track continues without a detection."""

    @model_validator(mode="after")
    def can_be_confirmed(self) -> OnboardSettings:
        """Check that the detections that confirm a track fit into the looks among which they are counted."""
        if self.confirm_hits > self.confirm_looks:
            raise ValueError(
                f"confirm_hits = {self.confirm_hits}: expected at most confirm_looks = {self.confirm_looks}"
            )
        return self


class OnboardSensor:
    """The sensor of one ego.

    A pedestrian is unknown until their track is confirmed. From then on the filter's estimate is reported;
    without a detection, it is extrapolated at the last velocity.
    """

    def __init__(self, settings: OnboardSettings, site: Site, seed: int, ego: str) -> None:
        self._settings = settings
        self._walls = site.walls
        self._noise = Noise(seed, f"vision:{ego}")
        self._tracks = Tracks(
            settings.confirm_hits,
            settings.confirm_looks,
            settings.hold_s,
            settings.position_noise_m,
            settings.velocity_noise_mps,
        )

    def look(self, scene: Scene) -> Belief:
        """Return what the ego knows now."""
        settings, count = self._settings, len(scene.names)
        eye = self._eye(scene)
        field_of_view = math.radians(settings.field_of_view_deg)
        within = lines_of_sight.in_view(eye, scene.heading, scene.position, settings.range_m, field_of_view)
        seen = np.zeros(count, dtype=np.bool_)
        seen[within] = lines_of_sight.visible(
            eye, scene.position[within], scene.radius[within], lines_of_sight.vehicles_in(scene), self._walls
        )
        draws = self._noise.draw(scene.names, scene.tick)
        detected = seen & (draws.uniform >= settings.miss_probability)
        measured = np.concatenate([scene.position, scene.velocity], axis=1)
        measured += draws.normal * np.repeat([settings.position_noise_m, settings.velocity_noise_mps], 2)
        told, estimate, deviation, age = self._tracks.update(scene.time, scene.names, detected, measured)
        estimate[~told] = deviation[~told] = age[~told] = np.nan
        return Belief(
            told,
            estimate[:, :2],
            estimate[:, 2:],
            deviation,
            age,
            lines_of_sight.states(within, seen, detected),
        )

    def _eye(self, scene: Scene) -> FloatArray:
        ahead = scene.body.front - self._settings.mount_behind_front_m
        left = self._settings.mount_left_m
        cosine, sine = math.cos(scene.heading), math.sin(scene.heading)
        return np.array([scene.x + ahead * cosine - left * sine, scene.y + ahead * sine + left * cosine])
