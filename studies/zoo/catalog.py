"""All networks of the zoo by name, and how much each is driven."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass

from studies.zoo import collected, generated, plain
from studies.zoo.programs import ZooError
from studies.zoo.recipe import Recipe

CONTROLLERS = ("vo_mpc", "aeb", "sumo")
EGO_SHARE = 0.2
QUICK = (
    "grid-signals",
    "grid-right-first",
    "grid-left-hand",
    "random-short",
    "spider-priority",
    "roundabouts",
    "refuges",
    "rilsa1",
)


@dataclass(frozen=True, slots=True)
class Plan:
    """How much of the zoo is driven."""

    seed: int
    """Seed of networks and demand."""
    duration_s: float = 300.0
    """Simulated time of a run [s]."""
    runs: int = 2
    """Number of runs of each controller on each network, each with its own seed."""
    ego_share: float = EGO_SHARE
    """Share of the passenger cars that a controller drives."""
    controllers: tuple[str, ...] = CONTROLLERS

    def run_seeds(self, factor: int = 1) -> list[int]:
        """Return the seeds of the runs, which depend on the seed of the zoo."""
        rng = random.Random(f"{self.seed}-runs")
        return [rng.randrange(1, 10**6) for _ in range(factor * self.runs)]


def all_recipes() -> tuple[list[Recipe], list[str]]:
    """Return all networks that can be made here, and one line for each source that is missing."""
    found, missing = collected.recipes()
    return [*generated.recipes(), *plain.recipes(), *found, *collected.as_they_are()], missing


def chosen(names: Sequence[str]) -> list[Recipe]:
    """Return the networks with given names.

    Raises
    ------
    ZooError
        If a name does not exist.
    """
    recipes, missing = all_recipes()
    by_name = {recipe.name: recipe for recipe in recipes}
    for name in names:
        if name not in by_name:
            exist = ", ".join(by_name)
            raise ZooError(f"no network {name!r}; there are {exist}{''.join(f'; {one}' for one in missing)}")
    return [by_name[name] for name in names]
