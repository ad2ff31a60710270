"""Networks for which ``netgenerate`` has no option: roundabouts, refuges, and osmWebWizard's settings."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable
from pathlib import Path

from studies.zoo.generated import WALKS
from studies.zoo.programs import call, without_comments
from studies.zoo.recipe import NET, Demand, Recipe

Point = tuple[float, float]
"""East, north [m]."""

ARMS: tuple[Point, ...] = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""Directions of the streets at a junction, counter-clockwise."""
RING_SPEED_MPS = 8.3
STREET_SPEED_MPS = 13.89
"""Speed limit of the streets; netconvert guesses crossings only up to this limit [m/s]."""
WIZARD = (
    *(
        "--geometry.remove",
        "--junctions.join",
        "--ramps.guess",
        "--tls.guess-signals",
        "--tls.discard-simple",
    ),
    *("--tls.join", "--tls.default-type", "actuated", "--crossings.guess", "--sidewalks.guess"),
)
"""Options that osmWebWizard passes to ``netconvert``, except those that need OpenStreetMap's tags."""


def recipes() -> list[Recipe]:
    """Return the networks."""
    wizard = Demand(
        car_options=("--min-distance", "300", "--remove-loops", "--trip-attributes", 'departLane="best"'),
        forgiving=True,
    )
    options = (
        '<processing><ignore-route-errors value="true"/><tls.actuated.jam-threshold value="30"/></processing>'
        '<routing><device.rerouting.adaptation-steps value="18"/></routing>'
    )
    return [
        Recipe("roundabouts", "four roundabouts", _roundabouts),
        Recipe("refuges", "avenues with a median, crossings in two parts", _refuges),
        Recipe("web-wizard", "random, settings of osmWebWizard", _wizard, wizard, own_options=options),
    ]


def _roundabouts(folder: Path, rng: random.Random) -> None:
    """Make four roundabouts joined by streets, each with two streets that leave the town."""
    radius, distance, lanes = rng.uniform(14.0, 22.0), rng.uniform(150.0, 220.0), rng.choice((1, 2))
    nodes: list[str] = []
    edges: list[str] = []
    for column in range(2):
        for row in range(2):
            place = f"{column}{row}"
            centre = (column * distance, row * distance)
            for number, arm in enumerate(ARMS):
                nodes.append(_node(f"{place}.{number}", _along(centre, arm, radius)))
                following = (number + 1) % 4
                shape = _arc(centre, radius, number * math.pi / 2)
                ring = f'speed="{RING_SPEED_MPS}" numLanes="1" priority="9" shape="{shape}"'
                edges.append(
                    _edge(f"ring{place}.{number}", f"{place}.{number}", f"{place}.{following}", ring)
                )
                there = (column + arm[0], row + arm[1])
                if 0 <= there[0] <= 1 and 0 <= there[1] <= 1:
                    other = f"{there[0]:.0f}{there[1]:.0f}.{(number + 2) % 4}"
                else:
                    other = f"out{place}.{number}"
                    nodes.append(_node(other, _along(centre, arm, radius + 120.0)))
                    edges.append(_street(other, f"{place}.{number}", lanes))
                edges.append(_street(f"{place}.{number}", other, lanes))
    _convert(folder, nodes, edges, "--roundabouts.guess", "--crossings.guess.roundabout-priority")


def _refuges(folder: Path, rng: random.Random) -> None:
    """Make three by three junctions whose streets have a median, so that crossings have two parts."""
    distance, lanes = rng.uniform(130.0, 190.0), rng.choice((1, 2))
    half_median_m = rng.uniform(1.5, 3.0)
    kind = rng.choice(("traffic_light", "priority"))
    places = [(column, row) for column in range(3) for row in range(3)]
    nodes = [_node(f"{c}{r}", (c * distance, r * distance), kind) for c, r in places]
    edges = []
    for column, row in places:
        for arm in ARMS:
            there = (column + int(arm[0]), row + int(arm[1]))
            if there in places:
                start = (column * distance, row * distance)
                # Shifting each direction to its right by half the median leaves room for the median.
                right = (start[0] + arm[1] * half_median_m, start[1] - arm[0] * half_median_m)
                shape = _points([right, _along(right, arm, distance)])
                edges.append(_street(f"{column}{row}", f"{there[0]}{there[1]}", lanes, f'shape="{shape}"'))
    _convert(folder, nodes, edges)


def _wizard(folder: Path, rng: random.Random) -> None:
    """Make a random network with the options that osmWebWizard passes to ``netconvert``."""
    seed, iterations = rng.randrange(10**6), rng.randrange(30, 50)
    shape = ("--rand", f"--rand.iterations={iterations}", "--rand.min-distance=50", "--rand.max-distance=180")
    lanes = ("-L", rng.choice((1, 2)), "--random-lanenumber", "--seed", seed)
    call("netgenerate", *shape, *lanes, "--tls.guess", "--plain-output-prefix", "raw", folder=folder)
    parts = [f"raw.{part}.xml" for part in ("nod", "edg", "con")]
    call("netconvert", "-n", parts[0], "-e", parts[1], "-x", parts[2], *WIZARD, "-o", NET, folder=folder)
    for path in folder.glob("raw.*"):
        path.unlink()
    without_comments(folder / NET)


def _convert(folder: Path, nodes: Iterable[str], edges: Iterable[str], *options: str) -> None:
    (folder / "n.nod.xml").write_text(f"<nodes>{''.join(nodes)}</nodes>", "utf-8")
    (folder / "e.edg.xml").write_text(f"<edges>{''.join(edges)}</edges>", "utf-8")
    call("netconvert", "-n", "n.nod.xml", "-e", "e.edg.xml", *WALKS, *options, "-o", NET, folder=folder)
    without_comments(folder / NET)


def _along(start: Point, arm: Point, way: float) -> Point:
    return start[0] + way * arm[0], start[1] + way * arm[1]


def _arc(centre: Point, radius: float, begin: float) -> str:
    """Return a quarter of a circle that starts at an angle [rad]."""
    angles = [begin + step * math.pi / 16 for step in range(9)]
    return _points(_along(centre, (math.cos(angle), math.sin(angle)), radius) for angle in angles)


def _points(points: Iterable[Point]) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in points)


def _node(name: str, place: Point, kind: str = "priority") -> str:
    return f'<node id="{name}" x="{place[0]:.2f}" y="{place[1]:.2f}" type="{kind}"/>'


def _street(start: str, end: str, lanes: int, more: str = "") -> str:
    attributes = f'speed="{STREET_SPEED_MPS}" numLanes="{lanes}" priority="1" {more}'
    return _edge(f"{start}to{end}", start, end, attributes)


def _edge(name: str, start: str, end: str, attributes: str) -> str:
    return f'<edge id="{name}" from="{start}" to="{end}" {attributes}/>'
