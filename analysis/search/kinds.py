"""Groups failures into kinds, by what happened and then by where in the space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage

from analysis.search.axes import Axis, Point, shares

APART = 0.25
"""Failures of one kind are connected by steps shorter than this share of the space's size; all axes weigh
the same."""
NARROW = 0.5
"""The name of a kind mentions only axes of which it covers less than this share."""
MOST_NAMED = 3


@dataclass(frozen=True, slots=True)
class Failure:
    """A trial that failed."""

    trial: int
    seed: int
    point: Point
    margin: float
    criterion: str
    facts: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Kind:
    """A group of similar failures."""

    name: str
    """What happened and where in the space, in words."""
    failures: tuple[Failure, ...]
    """The clearest failure first."""

    @property
    def worst(self) -> Failure:
        """The clearest failure."""
        return self.failures[0]


def kinds(axes: Sequence[Axis], failures: Sequence[Failure]) -> list[Kind]:
    """Return the kinds, the clearest failure first.

    Failures are of one kind if the same happened (`happening`) with the same choices, and if their numbers
    are connected by single linkage with steps of at most `APART`.
    """
    groups: dict[tuple[str, ...], list[Failure]] = {}
    for one in failures:
        choices = (str(one.point[axis.name]) for axis in axes if not axis.numeric)
        groups.setdefault((happening(one), *choices), []).append(one)
    found = []
    for some in groups.values():
        numeric = [axis for axis in axes if axis.numeric and axis.matters(some[0].point)]
        for members in _connected(numeric, some):
            ordered = tuple(sorted(members, key=lambda one: (one.margin, one.trial)))
            found.append(Kind(_name(axes, ordered), ordered))
    found.sort(key=lambda kind: (kind.worst.margin, kind.worst.trial))
    return _with_own_names(found)


def happening(failure: Failure) -> str:
    """Return what happened, in words."""
    facts = failure.facts
    if facts.get("collision") != "1":
        return f"{failure.criterion}: not met"
    speed = float(facts.get("impact_speed_kmh") or 0.0)
    severity = "slow" if speed < 10.0 else "at speed" if speed < 30.0 else "hard"
    words = ["contact", severity]
    if side := facts.get("impact_side"):
        words.append(f"at the {side}")
    if place := facts.get("contact_place"):
        words.append(f"on the {place.replace('_', ' ')}")
    if (moved := facts.get("contact_moved_by")) == "pedestrian":
        words.append("that the pedestrian closed")
    elif moved == "ego":
        words.append("that the ego closed")
    return " ".join(words)


def _connected(axes: Sequence[Axis], some: Sequence[Failure]) -> list[list[Failure]]:
    if len(some) == 1 or not axes:
        return [list(some)]
    places = shares(axes, [one.point for one in some]) / np.sqrt(len(axes))
    labels = fcluster(linkage(places, "single"), APART, "distance")
    return [
        [one for one, label in zip(some, labels, strict=True) if label == each] for each in np.unique(labels)
    ]


def _name(axes: Sequence[Axis], failures: Sequence[Failure]) -> str:
    told = []
    covered = []
    for axis in axes:
        if not axis.matters(failures[0].point):
            continue
        values = [one.point[axis.name] for one in failures]
        if not axis.numeric:
            told.append(f"{axis.name} {values[0]}")
            continue
        places = [axis.share(value) for value in values]
        covered.append((max(places) - min(places), axis, min(values), max(values)))
    if len(failures) > 1:
        covered.sort(key=lambda one: one[0])
    for width, axis, low, high in covered[:MOST_NAMED]:
        if width < NARROW:
            told.append(f"{axis.name} {low:g}" if low == high else f"{axis.name} {low:g} to {high:g}")
    return happening(failures[0]) + (": " + ", ".join(told) if told else "")


def _with_own_names(found: Sequence[Kind]) -> list[Kind]:
    seen: dict[str, int] = {}
    named = []
    for kind in found:
        seen[kind.name] = seen.get(kind.name, 0) + 1
        number = seen[kind.name]
        named.append(kind if number == 1 else replace(kind, name=f"{kind.name} ({number})"))
    return named
