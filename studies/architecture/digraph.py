"""Directed graphs as mappings from a node to the set of nodes that its arrows point to."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from typing import TypeVar

Node = TypeVar("Node", bound=Hashable)


def reachable(start: Node, arrows: Mapping[Node, set[Node]]) -> set[Node]:
    """Return the nodes that at least one arrow leads to from a node."""
    found: set[Node] = set()
    waiting = [start]
    while waiting:
        new = arrows[waiting.pop()] - found
        found |= new
        waiting.extend(new)
    return found


def cycles_merged(arrows: Mapping[str, set[str]]) -> list[frozenset[str]]:
    """Return the groups of nodes that reach each other; a node outside all cycles is a group of its own."""
    below = {node: reachable(node, arrows) for node in arrows}
    return sorted(
        {frozenset({node} | {other for other in below[node] if node in below[other]}) for node in arrows},
        key=sorted,
    )


def between_groups(groups: Iterable[Iterable[str]], arrows: Mapping[str, set[str]]) -> dict[int, set[int]]:
    """Return the arrows between groups of nodes, by the number of the group."""
    group_of = {node: number for number, group in enumerate(groups) for node in group}
    found: dict[int, set[int]] = {number: set() for number in group_of.values()}
    for node, targets in arrows.items():
        found[group_of[node]] |= {group_of[target] for target in targets} - {group_of[node]}
    return found


def heights(arrows: Mapping[Node, set[Node]]) -> dict[Node, int]:
    """Return the number of arrows on the longest way down from each node of a graph without cycles."""
    known: dict[Node, int] = {}

    def height(node: Node) -> int:
        if node not in known:
            known[node] = max((1 + height(target) for target in arrows[node]), default=0)
        return known[node]

    for node in arrows:
        height(node)
    return known


def without_shortcuts(arrows: Mapping[Node, set[Node]]) -> dict[Node, set[Node]]:
    """Return the graph without the arrows that a chain of other arrows replaces; it has no cycles."""
    below = {node: reachable(node, arrows) for node in arrows}
    return {
        node: {
            target for target in targets if not any(target in below[other] for other in targets - {target})
        }
        for node, targets in arrows.items()
    }
