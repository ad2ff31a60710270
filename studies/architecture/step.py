"""The calls of a step, in their order, read from the source of the loop and the protocols that it calls."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, is_dataclass
from types import ModuleType
from typing import Any, get_type_hints


@dataclass(frozen=True)
class Call:
    """One call of a protocol's method."""

    protocol: str
    """Name of the protocol's class."""
    module: str
    """Where it is declared."""
    method: str
    given: tuple[str, ...]
    """Dataclasses among the types of its arguments; numbers, names and functions are left out."""
    loops: tuple[str, ...]
    """First lines of the loops around the call, from the outermost to the innermost."""


def read_step(loop: ModuleType) -> list[Call]:
    """Return the calls that a loop's module makes to its protocols, in the order of execution.

    The step is the function with a ``while`` loop; calls of functions of the same module are followed.
    """
    functions = {
        node.name: node
        for node in ast.parse(inspect.getsource(loop)).body
        if isinstance(node, ast.FunctionDef)
    }
    (step,) = (
        name
        for name, function in functions.items()
        if any(isinstance(node, ast.While) for node in ast.walk(function))
    )
    return list(_Reader(loop, functions).calls(functions[step], ()))


class _Reader:
    def __init__(self, module: ModuleType, functions: Mapping[str, ast.FunctionDef]) -> None:
        self.module = module
        self.functions = functions

    def calls(self, function: ast.FunctionDef, loops: tuple[str, ...]) -> Iterator[Call]:
        """Yield the calls in a function, with the loops around its own call."""
        types = get_type_hints(getattr(self.module, function.name))
        for statement in function.body:
            yield from self._within(statement, types, loops)

    def _within(self, node: ast.AST, types: Mapping[str, Any], loops: tuple[str, ...]) -> Iterator[Call]:
        if isinstance(node, ast.For):
            yield from self._within(node.iter, types, loops)
            loops = (*loops, f"for {ast.unparse(node.target)} in {ast.unparse(node.iter)}")
            children: list[ast.AST] = list(node.body)
        else:
            if isinstance(node, ast.While):
                loops = (*loops, f"while {ast.unparse(node.test)}")
            children = list(ast.iter_child_nodes(node))
        for child in children:
            yield from self._within(child, types, loops)
        if isinstance(node, ast.Call):
            yield from self._called(node, types, loops)

    def _called(self, node: ast.Call, types: Mapping[str, Any], loops: tuple[str, ...]) -> Iterator[Call]:
        called = node.func
        if isinstance(called, ast.Name) and called.id in self.functions:
            yield from self.calls(self.functions[called.id], loops)
        if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
            protocol = types.get(called.value.id)
            if isinstance(protocol, type) and getattr(protocol, "_is_protocol", False):
                yield _call(protocol, called.attr, loops)


def _call(protocol: type, method: str, loops: tuple[str, ...]) -> Call:
    hints = get_type_hints(getattr(protocol, method))
    hints.pop("return", None)
    given = tuple(hint.__name__ for hint in hints.values() if isinstance(hint, type) and is_dataclass(hint))
    return Call(protocol.__name__, protocol.__module__, method, given, loops)
