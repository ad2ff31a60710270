"""Makes a town of the zoo: network, demand and configuration in a folder, determined by the seed."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import sumolib

from studies.zoo.programs import ZooError, call, without_comments
from studies.zoo.recipe import MOST_TIMES, NET, USUAL_KM, Demand, Recipe

STEP_S = 0.1
CARS, PEOPLE = "cars.rou.xml", "people.rou.xml"


def make(recipe: Recipe, seed: int, duration_s: float, folder: Path) -> Path:
    """Make a town if it does not exist yet, and return its configuration.

    Parameters
    ----------
    recipe : Recipe
    seed : int
        Seed of the zoo.
    duration_s : float
        Time during which cars and people set out [s].
    folder : Path

    Raises
    ------
    ZooError
        If one of SUMO's programs does not make its part.
    """
    configuration = folder / (recipe.configuration or f"{recipe.name}.sumocfg")
    if configuration.exists():
        return configuration
    part = folder.with_name(f"{folder.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    shutil.rmtree(folder, ignore_errors=True)
    part.mkdir(parents=True)
    rng = random.Random(f"{seed}-{recipe.name}")
    recipe.make(part, rng)
    if not recipe.as_it_is:
        routes = _demand(part, recipe.demand, duration_s, rng)
        (part / configuration.name).write_text(_configuration(routes, recipe.own_options), "utf-8")
    part.replace(folder)
    return configuration


def _demand(folder: Path, demand: Demand, duration_s: float, rng: random.Random) -> list[str]:
    """Write the routes of cars and people under the names that ``randomTrips.py`` gives them."""
    seed = rng.randrange(10**6)
    times = min(max(_street_km(folder / NET) / USUAL_KM, 1.0), MOST_TIMES)
    common = ("-n", NET, "--end", duration_s, "--fringe-factor", 3)
    forgiving = ("--min-success-rate", 0) if demand.forgiving else ()
    period = ("--period", round(demand.car_period_s / times, 2), "--seed", seed, "--validate", *forgiving)
    call(
        *("randomTrips.py", *common, *period, *demand.car_options),
        *("-o", "trips.xml", "-r", CARS),
        folder=folder,
    )
    (folder / "trips.xml").unlink(missing_ok=True)
    routes = [CARS]
    if 'function="crossing"' in (folder / NET).read_text("utf-8"):
        period = ("--period", round(demand.person_period_s / times, 2), "--seed", seed + 1)
        people = (
            "randomTrips.py",
            *common[:4],
            *period,
            "--pedestrians",
            *demand.person_options,
            "-o",
            PEOPLE,
        )
        call(*people, folder=folder)
        routes.append(PEOPLE)
    for path in (*folder.glob("*.rou.alt.xml"), folder / "routes.rou.xml"):  # left by the routing
        path.unlink(missing_ok=True)
    for name in routes:
        if not (folder / name).exists():
            raise ZooError(f"randomTrips.py wrote no {name}")
        without_comments(folder / name)
    return routes


def _street_km(net: Path) -> float:
    """Return the total length of all edges for cars, counting each direction separately [km]."""
    edges = sumolib.net.readNet(str(net)).getEdges(withInternal=False)
    return sum(float(edge.getLength()) for edge in edges if edge.allows("passenger")) / 1000.0


def _configuration(routes: list[str], options: str) -> str:
    return (
        "<configuration>"
        f'<input><net-file value="{NET}"/><route-files value="{",".join(routes)}"/></input>'
        f'<time><step-length value="{STEP_S}"/></time>{options}'
        "</configuration>\n"
    )
