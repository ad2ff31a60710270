"""Networks in installed packages: SUMO's games and RiLSA examples, and the networks of ``sumo-rl``."""

from __future__ import annotations

import gzip
import importlib.util
import random
import re
import shutil
from functools import partial
from pathlib import Path

from studies.zoo.programs import HOME, ZooError, call, without_comments
from studies.zoo.recipe import NET, Demand, Recipe

GAMES = HOME / "tools" / "game"
RILSA = HOME / "tools" / "sumolib" / "scenario" / "scenarios" / "RealWorld"
NO_CARS = ("rail",)
"""Beginnings of the names of configurations without passenger cars."""
TOWN_SPEED_MPS = 17.0
"""Sidewalks and crossings are guessed for roads up to this speed limit [m/s]."""

RUN_FACTORS = {"A10KW": 3, "DRT": 3}
"""Factors on the number of runs of games whose networks have few pedestrians for their size."""

_NET_OF_GAME = re.compile(r'net-file value="([^"]+)"')


def recipes() -> tuple[list[Recipe], list[str]]:
    """Return the available networks, and one line for each missing package."""
    found = [*_games(), *_rilsa()]
    resco = _resco()
    missing = [] if resco else ["sumo-rl is not installed: its Cologne and Ingolstadt networks are left out"]
    return [*found, *resco], missing


def as_they_are() -> list[Recipe]:
    """Return the configurations of SUMO's games, to be run unchanged."""
    return [
        Recipe(
            f"as-is-{path.stem.lower().replace('_', '-')}",
            f"tools/game/{path.name} as it is",
            partial(_copy_game, path),
            configuration=path.name,
        )
        for path in _game_configurations()
    ]


def _games() -> list[Recipe]:
    """Return one recipe for each network of a game."""
    nets: dict[Path, str] = {}
    for path in _game_configurations():
        match = _NET_OF_GAME.search(path.read_text("utf-8"))
        if match is not None:
            nets.setdefault(GAMES / match[1], path.name)
    return [
        _recipe(
            f"game-{net.parent.name.lower().replace('_', '-')}",
            f"SUMO's game {net.parent.name}",
            net,
            RUN_FACTORS.get(net.parent.name, 1),
        )
        for net in nets
    ]


def _game_configurations() -> list[Path]:
    return [path for path in sorted(GAMES.glob("*.sumocfg")) if not path.name.startswith(NO_CARS)]


def _rilsa() -> list[Recipe]:
    nets = sorted(RILSA.glob("RiLSA_example*/rilsa*.net.xml"))
    return [_recipe(net.name.removesuffix(".net.xml"), f"sumolib's {net.parent.name}", net) for net in nets]


def _resco() -> list[Recipe]:
    spec = importlib.util.find_spec("sumo_rl")
    if spec is None or spec.origin is None:
        return []
    nets = sorted((Path(spec.origin).parent / "nets" / "RESCO").glob("*/*.net.xml"))
    return [
        _recipe(f"resco-{net.parent.name}", f"RESCO's {net.parent.name}", net)
        for net in nets
        if net.parent.name.startswith(("cologne", "ingolstadt"))
    ]


def _recipe(name: str, what: str, net: Path, run_factor: int = 1) -> Recipe:
    options = '<processing><ignore-route-errors value="true"/></processing>'
    make = partial(_with_crossings, net)
    return Recipe(name, what, make, Demand(forgiving=True), run_factor, own_options=options)


def _with_crossings(net: Path, folder: Path, rng: random.Random) -> None:
    """Copy a network, with crossings guessed if it has none."""
    plain = folder / "as-found.net.xml"
    content = net.read_bytes()
    plain.write_bytes(gzip.decompress(content) if net.suffix == ".gz" else content)
    if 'function="crossing"' in plain.read_text("utf-8"):
        plain.replace(folder / NET)
    else:
        guess = ("--sidewalks.guess", "--sidewalks.guess.max-speed", TOWN_SPEED_MPS)
        across = ("--crossings.guess", "--crossings.guess.speed-threshold", TOWN_SPEED_MPS)
        call("netconvert", "-s", plain.name, *guess, *across, "--walkingareas", "-o", NET, folder=folder)
        plain.unlink()
    without_comments(folder / NET)


def _copy_game(path: Path, folder: Path, rng: random.Random) -> None:
    """Copy a configuration and the files it names, so that nothing is written into the installed package."""
    try:
        for name in sorted(set(re.findall(r'value="([^"]+\.(?:xml|gz)[^"]*)"', path.read_text("utf-8")))):
            for part in name.split(","):
                source = GAMES / part.strip()
                if source.exists():
                    (folder / part.strip()).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copyfile(source, folder / part.strip())
        shutil.copyfile(path, folder / path.name)
    except OSError as error:
        raise ZooError(f"{path} could not be copied: {error.strerror}") from error
