"""Reads the results of all runs of the zoo."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from analysis.files import read_csv, read_json
from studies.zoo.catalog import EGO_SHARE, Plan
from studies.zoo.driving import RESULTS, STATE, seeds_of
from studies.zoo.recipe import Recipe

_WORK = re.compile(rf"{RESULTS}/\.work/[^\s:]*/run/?")
"""Matches the working folder of a run, which no longer exists when the reason is read."""
DEFAULT_DURATION_S = Plan(0).duration_s


@dataclass(frozen=True, slots=True)
class Contact:
    """One encounter in which an ego and a pedestrian touched."""

    ego: str
    person: str
    time_s: float | None
    impact_kmh: float | None
    """Impact speed; ``None`` if the ego stood."""
    preventable: bool
    """Whether the careful driver would have avoided it; undefined counts as preventable."""
    place: str = ""
    """Place of the contact; empty if the analysis does not say."""
    moved_by: str = ""
    kind: str = ""


@dataclass(frozen=True, slots=True)
class Run:
    """One requested run."""

    network: str
    controller: str
    seed: int
    reason: str
    """Why it is not valid; empty if it is."""
    of_sumo: bool
    """Whether it ended, but is not valid because SUMO teleported an ego."""
    command: str
    """Command that makes only this run."""
    numbers: Mapping[str, float]
    """Its row of ``runs.csv``; empty if there is none."""
    contacts: tuple[Contact, ...]
    """Contacts with a moving ego, including those of a run that failed later."""

    @property
    def valid(self) -> bool:
        """Whether it reached its end without a fault."""
        return not self.reason

    def number(self, name: str) -> float:
        """Return a number from its row of ``runs.csv``.

        Raises
        ------
        KeyError
            If there is no such column, or it is empty: nobody should take that for a 0.
        """
        return self.numbers[name]


def read(recipe: Recipe, plan: Plan, folder: Path) -> list[Run]:
    """Return all planned runs of a network, made or not.

    Parameters
    ----------
    recipe : Recipe
    plan : Plan
    folder : Path
        Folder of this network.
    """
    results = folder / RESULTS
    made = {_key(read_json(one / "job.json")): one for one in _folders(results / "runs")}
    failures: dict[tuple[str, int], tuple[str, Path]] = {}
    for one in _folders(results / "failed"):
        failure = read_json(one / "failure.json")
        failures[_key(failure)] = (str(failure["reason"]), one / "run")
    state = read_json(folder / STATE) if (folder / STATE).exists() else {}
    otherwise = str(state.get("said") or "not run")
    runs = []
    for controller in plan.controllers:
        for seed in seeds_of(recipe, plan):
            key = (controller, seed)
            reason, place = ("", made[key]) if key in made else failures.get(key, (otherwise, None))
            runs.append(_run(recipe, plan, controller, seed, reason, place))
    return runs


def command(recipe: Recipe, plan: Plan, controller: str, seed: int) -> str:
    """Return the command that makes a network and one run on it."""
    words = f"python -m studies.zoo one {plan.seed} {recipe.name} --controller {controller} --run-seed {seed}"
    if plan.duration_s != DEFAULT_DURATION_S:
        words += f" --duration-s {plan.duration_s:g}"
    if plan.ego_share != EGO_SHARE:
        words += f" --ego-share {plan.ego_share:g}"
    return words


def _run(recipe: Recipe, plan: Plan, controller: str, seed: int, reason: str, place: Path | None) -> Run:
    rows = _rows(place / "runs.csv") if place is not None else []
    row = rows[0] if rows else {}
    of_sumo = not reason and row.get("valid") == "0"
    return Run(
        network=recipe.name,
        controller=controller,
        seed=seed,
        reason=row["invalid_reason"] or "not valid" if of_sumo else _WORK.sub("", reason),
        of_sumo=of_sumo,
        command=command(recipe, plan, controller, seed),
        numbers={name: value for name, cell in row.items() if (value := _number(cell)) is not None},
        contacts=tuple(_contacts(place / "encounters.csv")) if place is not None else (),
    )


def _contacts(path: Path) -> Iterator[Contact]:
    for row in _rows(path):
        if row["collision"] == "1":
            yield Contact(
                ego=row["ego_id"],
                person=row["ped_id"],
                time_s=_number(row["t_collision_s"]),
                impact_kmh=_number(row["impact_speed_kmh"]),
                preventable=row["preventable_r157"] != "0",
                place=row.get("contact_place", ""),
                moved_by=row.get("contact_moved_by", ""),
                kind=row.get("contact_class", ""),
            )


def _folders(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.is_dir()) if folder.is_dir() else []


def _key(note: Mapping[str, object]) -> tuple[str, int]:
    return str(note["controller"]), int(str(note["seed"]))


def _rows(path: Path) -> list[dict[str, str]]:
    if not path.exists():
        return []
    return read_csv(path)


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
