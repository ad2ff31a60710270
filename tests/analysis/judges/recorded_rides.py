"""A judge of recorded rides in a bend: shapely at every millisecond."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from analysis.encounters.case import prepare
from analysis.recording.reading import read_run
from tests.analysis.judges.agreement import Agreement, agreement
from tests.analysis.judges.uniform_motion import rectangles
from tests.analysis.recorded import Ego, Person, line, write_run


def curved_rides(step: float, count: int = 40, seed: int = 7) -> Agreement:
    """Judge the smallest distance of recorded curved and braking rides by shapely at every millisecond."""
    rng = np.random.default_rng(seed)
    differences = []
    with tempfile.TemporaryDirectory() as name:
        for number in range(count):
            bend, speed, braking = rng.uniform(-0.08, 0.08), rng.uniform(5, 9), rng.uniform(0.0, 1.0)
            ride = _Ride(bend, speed, braking)
            # Aims at where the ego is after 3 to 5 s, so that most pass close by.
            place = np.array(ride.centre(rng.uniform(3, 5))) + rng.uniform(-3, 3, 2)
            walk = rng.uniform(-1.5, 1.5, 2)
            start = place - 4.0 * walk
            folder = write_run(
                Path(name) / str(number),
                [ride.ego()],
                [Person(line(*start, *walk), crossing="zebra")],
                step=step,
                duration=7.0,
                areas=(),
            )
            case = prepare(read_run(folder))
            time = np.arange(0.0, 7.0, 0.001)
            centres = np.array([ride.centre(t) for t in time])
            headings = np.array([ride.heading(t) for t in time])
            bodies = rectangles(centres, headings, np.full(len(time), 4.5), np.full(len(time), 1.8))
            persons = shapely.points(start + walk * time[:, None])
            least = max(float((shapely.distance(bodies, persons) - 0.25).min()), 0.0)
            (own,) = case.approach.distance
            differences.append(abs(own - least))
    title = f"smallest distance of a curved, braking ride, step {step:g} s"
    return agreement(title, "shapely, every 1 ms", count, np.array(differences), "m")


@dataclass(frozen=True)
class _Ride:
    """A rear axle on a circle, braking steadily."""

    bend: float
    speed: float
    braking: float

    def way(self, t: float) -> float:
        return self.speed * t - 0.5 * self.braking * t * t

    def heading(self, t: float) -> float:
        return self.bend * self.way(t)

    def centre(self, t: float, ahead: float = 1.3) -> tuple[float, float]:
        turn = self.heading(t)
        x = np.sin(turn) / self.bend + ahead * np.cos(turn)
        y = (1 - np.cos(turn)) / self.bend + ahead * np.sin(turn)
        return float(x), float(y)

    def ego(self) -> Ego:
        front = 1.3 + 2.25
        return Ego(
            self.centre,
            columns={
                "heading_rad": self.heading,
                "front_x_m": lambda t: self.centre(t, front)[0],
                "front_y_m": lambda t: self.centre(t, front)[1],
                "speed_mps": lambda t: self.speed - self.braking * t,
            },
        )
