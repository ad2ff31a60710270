"""The packages, the rooms in them and the imports between rooms, from the code and import-linter's contracts.

A room is a sub-package or a module directly below a package. A contract of layers gives the floors of its
package; without one, a room is on the lowest floor above everything that it imports.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import grimp

from studies.architecture.digraph import between_groups, cycles_merged, heights, without_shortcuts

Node = TypeVar("Node", int, str, tuple[str, ...])
Arrows = Mapping[str, set[str]]
Contracts = Sequence[Mapping[str, Any]]


@dataclass(frozen=True)
class Box:
    """What is drawn as one box: a sub-package, the modules of a floor, or rooms that import each other."""

    names: tuple[str, ...]
    is_package: bool = True


@dataclass(frozen=True)
class Package:
    """One package: its floors from top to bottom, and the arrows between their boxes."""

    name: str
    floors: tuple[tuple[Box, ...], ...]
    arrows: tuple[tuple[Box, Box], ...]


@dataclass(frozen=True)
class House:
    """All packages: rows from top to bottom, and the arrows between packages."""

    rows: tuple[tuple[Package, ...], ...]
    arrows: tuple[tuple[str, str], ...]


def read_house(project: Path) -> House:
    """Read the packages that import-linter checks; they must be importable."""
    linter = tomllib.loads((project / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    graph = grimp.build_graph(*linter["root_packages"], cache_dir=None)
    imports = {
        module: set(graph.find_modules_directly_imported_by(module)) for module in sorted(graph.modules)
    }
    arrows = _aggregated(imports, depth=1)
    rows = _by_height(heights(arrows))
    return House(
        rows=tuple(tuple(_package(name, imports, linter["contracts"]) for name in row) for row in rows),
        arrows=_pairs(without_shortcuts(arrows)),
    )


def _package(name: str, imports: Arrows, contracts: Contracts) -> Package:
    """Return a package with its rooms; one with a single sub-package is not divided."""
    inside = {module: targets for module, targets in imports.items() if module.startswith(f"{name}.")}
    rooms = _aggregated(inside, depth=2)
    divided = {module.rpartition(".")[0] for module in inside} & rooms.keys()
    if len(divided) < 2:
        return Package(name, (), ())
    arrows = {_last(room): {_last(target) for target in targets} for room, targets in rooms.items()}
    packages = {_last(room) for room in divided}
    ranks = _ranks(arrows, _layers(name, contracts))
    floors = tuple(_boxes(rank, packages) for rank in _by_height(ranks))
    boxes = [box for floor in floors for box in floor]
    between = without_shortcuts(between_groups([box.names for box in boxes], arrows))
    return Package(name, floors, tuple((boxes[start], boxes[end]) for start, end in _pairs(between)))


def _layers(package: str, contracts: Contracts) -> list[set[str]]:
    """Return the layers that a contract gives to the rooms of a package, from top to bottom, perhaps none."""
    for contract in contracts:
        if contract["type"] == "layers" and package in contract.get("containers", ()):
            return [set(re.split(r"\W+", layer)) - {""} for layer in contract["layers"]]
    return []


def _ranks(arrows: Arrows, layers: Sequence[set[str]]) -> dict[tuple[str, ...], tuple[int, int]]:
    """Return the place of all rooms, from below: the layer, then the height by the imports within the layer.

    Rooms that import each other are one. Layers that do not hold for all rooms are left out of account.
    """
    layer_of = {room: -number for number, layer in enumerate(layers) for room in layer}
    known = arrows.keys() <= layer_of.keys()
    if not known or any(layer_of[room] < layer_of[low] for room in arrows for low in arrows[room]):
        layer_of = dict.fromkeys(arrows, 0)
    same = {room: {low for low in arrows[room] if layer_of[low] == layer_of[room]} for room in arrows}
    groups = cycles_merged(same)
    height = heights(between_groups(groups, same))
    return {tuple(sorted(group)): (layer_of[min(group)], height[at]) for at, group in enumerate(groups)}


def _boxes(groups: Sequence[tuple[str, ...]], packages: set[str]) -> tuple[Box, ...]:
    """Return the boxes of one floor; its modules are drawn as one."""
    boxes = [Box(group) for group in groups if packages.intersection(group) or len(group) > 1]
    modules = tuple(name for group in groups for name in group if Box(group) not in boxes)
    return (*boxes, Box(modules, is_package=False)) if modules else tuple(boxes)


def _aggregated(imports: Arrows, depth: int) -> dict[str, set[str]]:
    """Return the imports between the ancestors of modules at a depth; those of fewer parts are left out."""
    found: dict[str, set[str]] = {}
    for module, targets in imports.items():
        if module.count(".") + 1 >= depth:
            room = _ancestor(module, depth)
            found.setdefault(room, set()).update(_ancestor(target, depth) for target in targets)
    return {room: (targets & found.keys()) - {room} for room, targets in found.items()}


def _ancestor(module: str, depth: int) -> str:
    return ".".join(module.split(".")[:depth])


def _last(module: str) -> str:
    return module.rpartition(".")[2]


def _by_height(places: Mapping[Node, Any]) -> list[tuple[Node, ...]]:
    """Return the nodes row by row, the highest place first."""
    return [
        tuple(sorted(node for node in places if places[node] == place))
        for place in sorted(set(places.values()), reverse=True)
    ]


def _pairs(arrows: Mapping[Node, set[Node]]) -> tuple[tuple[Node, Node], ...]:
    return tuple((start, end) for start in sorted(arrows) for end in sorted(arrows[start]))
