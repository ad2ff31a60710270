"""Networks from ``netgenerate``: grids, spider's webs and random networks with every kind of junction."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import partial
from pathlib import Path

from studies.zoo.programs import call, without_comments
from studies.zoo.recipe import NET, Recipe

WALKS = ("--sidewalks.guess", "--crossings.guess", "--walkingareas", "--no-turnarounds")

Options = list[object]
Draw = Callable[[random.Random], Options]


def grid(
    junctions: str, *more: str, lanes: tuple[int, ...] = (1, 2), length: tuple[int, int] = (90, 190)
) -> Draw:
    """Return a function that draws the options of a grid.

    Parameters
    ----------
    junctions : str
        Type of the junctions.
    more : str
        Further options of ``netgenerate``.
    lanes : tuple
        Numbers of lanes to choose from.
    length : tuple
        Shortest and longest street [m].
    """

    def draw(rng: random.Random) -> Options:
        size = [f"--grid.number={rng.randrange(3, 5)}", f"--grid.length={rng.randrange(*length)}"]
        return ["--grid", *size, "-L", rng.choice(lanes), "-j", junctions, *more]

    return draw


def spider(junctions: str, *more: str, lanes: tuple[int, ...] = (1, 2)) -> Draw:
    """Return a function that draws the options of a spider's web."""

    def draw(rng: random.Random) -> Options:
        arms, radius = rng.randrange(5, 9), rng.randrange(90, 150)
        size = [f"--spider.arm-number={arms}", "--spider.circle-number=3", f"--spider.space-radius={radius}"]
        return ["--spider", *size, "-L", rng.choice(lanes), "-j", junctions, *more]

    return draw


def scattered(
    junctions: str, *more: str, lanes: tuple[int, ...] = (1, 2), length: tuple[int, int] = (70, 180)
) -> Draw:
    """Return a function that draws the options of a random network; ``length`` of its streets [m]."""

    def draw(rng: random.Random) -> Options:
        size = [f"--rand.min-distance={length[0]}", f"--rand.max-distance={length[1]}"]
        shape = [f"--rand.iterations={rng.randrange(25, 45)}", *size]
        return ["--rand", *shape, "-L", rng.choice(lanes), "-j", junctions, *more]

    return draw


KINDS: dict[str, tuple[str, Draw]] = {
    "grid-signals": ("grid, signals, two lanes", grid("traffic_light", lanes=(2,))),
    "grid-priority": ("grid, priority roads", grid("priority")),
    "grid-right-first": ("grid, right before left", grid("right_before_left")),
    "grid-allway-stop": ("grid, all-way stops", grid("allway_stop")),
    "grid-three-lanes": ("grid, signals, three lanes", grid("traffic_light", lanes=(3,), length=(130, 200))),
    "grid-turn-lanes": (
        "grid, signals, left-turn lanes",
        grid("traffic_light", "--turn-lanes=1", "--turn-lanes.length=40", length=(130, 200)),
    ),
    "grid-red-right-turn": ("grid, right turns on red", grid("traffic_light_right_on_red")),
    "grid-stop-signs": ("grid, stop signs at minor roads", grid("priority_stop")),
    "grid-zipper": ("grid, zipper junctions", grid("zipper", lanes=(2,))),
    "grid-bike-lanes": ("grid, bicycle lanes", grid("priority", "--bikelanes.guess")),
    "grid-left-hand": ("grid, left-hand traffic, signals", grid("traffic_light", "--lefthand")),
    "grid-short": ("grid, streets of 35 to 80 m", grid("priority", length=(35, 80))),
    "grid-wide-walks": (
        "grid, crossings of 8 m, sidewalks of 4 m",
        grid("priority", "--default.crossing-width=8", "--default.sidewalk-width=4"),
    ),
    "grid-hills": (
        "grid bent and hilly",
        grid(
            "priority",
            "--perturb-x=normc(0,12,-25,25)",
            "--perturb-y=normc(0,12,-25,25)",
            "--perturb-z=normc(0,3,-6,6)",
        ),
    ),
    "spider-priority": ("spider's web, priority roads", spider("priority")),
    "spider-signals": ("spider's web, signals", spider("traffic_light")),
    "random-signals": ("random, signals", scattered("traffic_light")),
    "random-priority": ("random, priority roads", scattered("priority")),
    "random-right-first": (
        "random, right before left, one to three lanes",
        scattered("right_before_left", "--random-lanenumber", lanes=(3,)),
    ),
    "random-short": ("random, streets of 35 to 80 m", scattered("priority", length=(35, 80))),
}
"""Description and function that draws the options of each network, by name."""


def recipes() -> list[Recipe]:
    """Return the networks that ``netgenerate`` makes."""
    return [Recipe(name, what, partial(_make, draw)) for name, (what, draw) in KINDS.items()]


def _make(draw: Draw, folder: Path, rng: random.Random) -> None:
    options = draw(rng)
    seed = rng.randrange(10**6)
    call("netgenerate", *options, "--seed", seed, *WALKS, "--output-file", NET, folder=folder)
    without_comments(folder / NET)
