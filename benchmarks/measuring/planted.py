"""Planted faults: boxes in a space within which a controller fails, with or without a slope around them."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping, Sequence

from analysis.search.axes import Axis, Point
from analysis.search.objective import squashed
from controllers.interface import Decision, Manoeuvre, Perception, Plan, constant_command
from cosim.step import loop
from cosim.step.toy_road import ToyPedestrian, ToyRoad, walk
from cosim.step.toy_world import ToyWorld
from cosim.step.world import Snapshot

NUMBERS = 4
AXES = (*(Axis(f"x{number}") for number in range(NUMBERS)), Axis("place", choices=("a", "b", "c")))
SLOPE = 0.35
"""How far from a fault its margin still says where it is, as a share of an axis."""

Margin = Callable[[Point], float]


class Faults:
    """Boxes that together have a volume, each at one of the places.

    Parameters
    ----------
    volume
        Share of the space.
    count
        Number of boxes.
    seed
    slope
        Whether a margin falls towards them.
    """

    def __init__(self, volume: float, count: int, seed: int, slope: bool = True) -> None:
        generator = random.Random(seed)
        self.half = 0.5 * (volume / count * 3.0) ** (1.0 / NUMBERS)
        self.centres = [
            [generator.uniform(self.half, 1.0 - self.half) for _ in range(NUMBERS)] for _ in range(count)
        ]
        self.places = [generator.choice("abc") for _ in range(count)]
        self._slope = slope

    def margin(self, point: Point) -> float:
        """Return the margin: the distance to the nearest box, negative inside."""
        far = min(self._outside(number, point) for number in range(len(self.centres)))
        if far > 0.0 and not self._slope:
            return 1.0
        return squashed(4.0 * min(far, SLOPE))

    def hit(self, point: Point) -> int | None:
        """Return the box that a point is in."""
        inside = [i for i in range(len(self.centres)) if self._outside(i, point) < 0.0]
        return inside[0] if inside else None

    def _outside(self, number: int, point: Point) -> float:
        if point["place"] != self.places[number]:
            return SLOPE
        values = (float(point[f"x{i}"]) for i in range(NUMBERS))
        return (
            max(abs(value - at) for value, at in zip(values, self.centres[number], strict=True)) - self.half
        )


TOY_AXES = (
    Axis("gap_s", 3.5, 8.0),
    Axis("walking_mps", 0.9, 2.2),
    Axis("start_m", 1.0, 2.5),
    Axis("speed_mps", 8.0, 14.0),
)
"""Of somebody who walks to the middle of the ego's lane and stays there, before the ego comes."""
BRAKES_MPS2 = 7.0
BEFORE_M = 5.0
"""So far beyond the given gap, at the ego's speed, stands the pedestrian."""
NEAR_M = 2.2
"""Who is nearer to the middle of the lane is braked for."""
SPARE_S = 0.9
"""Next to a fault it brakes so long before it would be too late without lag: no contact is outside."""


class Sleepy:
    """Brakes for somebody in or near its lane, the later the nearer the scene is to its fault.

    Parameters
    ----------
    delay
        Time from when the pedestrian is on the road to when it brakes [s].
    """

    def __init__(self, delay: float) -> None:
        self._delay = delay
        self._seen: float | None = None

    def decide(self, perception: Perception) -> Decision:
        return Decision(Manoeuvre.KEEP, perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        time = perception.ego.time
        people = perception.pedestrians
        if any(
            abs(across) < NEAR_M and along > 0.0
            for along, across in zip(people.along, people.across, strict=True)
        ):
            self._seen = time if self._seen is None else self._seen
            if time - self._seen >= self._delay:
                return Plan(constant_command(-BRAKES_MPS2, 0.0))
        return Plan(constant_command(0.0, 0.0))


class _Nearest:
    """Takes down the smallest distance between ego and pedestrian, and the speed then."""

    def __init__(self) -> None:
        self.margin = 1.0

    def planned(self, *details: object) -> None:
        pass

    def stepped(self, snapshot: Snapshot) -> None:
        (ego,) = snapshot.egos
        x, y = float(snapshot.persons.x[0]), float(snapshot.persons.y[0])
        rear = ego.x - 4.5
        ahead = max(x - ego.x, rear - x, 0.0)
        beside = max(abs(y - ego.y) - 0.9, 0.0)
        gap = math.hypot(ahead, beside) - 0.25
        if gap <= 0.0 and ego.speed > 0.1:
            self.margin = min(self.margin, squashed(-ego.speed / 3.0))
        elif ego.speed > 0.5:
            self.margin = min(self.margin, squashed(max(gap, 0.0) / 2.0))


def toy_boxes(volume: float, count: int, seed: int) -> tuple[list[dict[str, float]], float]:
    """Return centres and half width of boxes that together have a volume, in shares of the axes."""
    half = 0.5 * (volume / count) ** (1.0 / len(TOY_AXES))
    generator = random.Random(seed)
    centres = [{axis.name: generator.uniform(half, 1.0 - half) for axis in TOY_AXES} for _ in range(count)]
    return centres, half


def toy_hit(faults: Sequence[Mapping[str, float]], half: float, point: Point) -> int | None:
    """Return the box that a point is in."""
    outside = _toy_outside(faults, point)
    inside = [number for number, far in enumerate(outside) if far <= half]
    return inside[0] if inside else None


def _toy_outside(faults: Sequence[Mapping[str, float]], point: Point) -> list[float]:
    shares = {axis.name: axis.share(point[axis.name]) for axis in TOY_AXES}
    return [max(abs(shares[name] - at) for name, at in one.items()) for one in faults]


def toy_margin(faults: Sequence[Mapping[str, float]], half: float, misleading: bool = False) -> Margin:
    """Return the margin of a drive on the toy road by a controller with a fault near some scenes.

    Parameters
    ----------
    faults, half
        Boxes, as `toy_boxes` returns them; inside the controller is asleep.
    misleading
        Whether it brakes up to 1 s later only next to a box. The margin depends more on the gap then, and
        falls towards small gaps. Otherwise it brakes later and later, at last just in time.
    """

    def margin(point: Point) -> float:
        far = min(_toy_outside(faults, point))
        gap, speed = float(point["gap_s"]), float(point["speed_mps"])
        start, walking = float(point["start_m"]), float(point["walking_mps"])
        seen = max(start - NEAR_M, 0.0) / walking
        latest = gap + BEFORE_M / speed - 0.5 * speed / BRAKES_MPS2 - seen - SPARE_S
        if far <= half:
            delay = math.inf
        elif misleading:
            delay = max(0.1, 1.0 - 3.0 * (far - half))
        else:
            delay = max(0.1, latest * (1.0 - (far - half) / SLOPE))
        person = walk(gap * speed + BEFORE_M, -start, 0.0, walking, stop=start / walking)
        world = ToyWorld(ToyRoad(), [ToyPedestrian("met", person)], speed=speed, duration=gap + 2.0)
        nearest = _Nearest()
        loop.run(world, {"ego": Sleepy(delay)}, nearest)
        return nearest.margin

    return margin
