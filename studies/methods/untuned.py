"""A network that nobody tuned for: ``netgenerate`` makes it from a seed, with three levels of demand.

It is one of the zoo's kinds, made with a seed that the zoo never used. Nobody looked at it before the study.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from pathlib import Path

from cosim.batches.study import StudyTable, study_of
from studies.zoo import generated, town
from studies.zoo.recipe import Demand, Recipe

NAME = "untuned_network"
KIND, SEED = "random-priority", 220_022
LEVELS = {"light": (2.0, 150.0), "busy": (1.4, 170.0), "crowded": (0.7, 130.0)}
"""Mean time between two pedestrians who set out, and duration of a run, for each level [s]."""
EGO_SHARE = 0.2


def tables(
    out: Path, controllers: Sequence[str], seeds: str | list[int], levels: Sequence[str]
) -> dict[str, StudyTable]:
    """Make the towns that are missing, and return the study for each level of demand, by level.

    Parameters
    ----------
    out : folder in which the towns are
    controllers : controllers that drive
    seeds : seeds of the runs
    levels : some of ``LEVELS``

    Raises
    ------
    ZooError
        If one of SUMO's programs does not make its part.
    """
    made = {}
    for level in levels:
        name = f"{NAME}_{level}"
        period_s, duration_s = LEVELS[level]
        recipe = Recipe(name, KIND, _network, Demand(person_period_s=period_s))
        configuration = town.make(recipe, SEED, duration_s, out.resolve() / "towns" / name)
        content = {
            "scenarios": [str(configuration)],
            "controllers": list(controllers),
            "seeds": seeds,
            "set": {"duration_s": duration_s, "ego_share": EGO_SHARE},
        }
        made[level] = study_of(content, name)
    return made


def _network(folder: Path, rng: random.Random) -> None:
    """Make the same network at every level; the level's own random generator is only used for its demand."""
    kinds = {recipe.name: recipe for recipe in generated.recipes()}
    kinds[KIND].make(folder, random.Random(f"{SEED}-{KIND}"))
