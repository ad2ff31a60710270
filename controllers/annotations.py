"""The parts of an annotation: the types of ``float | None``, the values of a ``Literal``."""

from __future__ import annotations

import types
from collections.abc import Iterable, Iterator
from enum import Enum
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo


def alternatives(hint: object) -> tuple[object, ...]:
    """Return the types and values that a type hint consists of.

    >>> alternatives(Annotated[float, "metres"] | None)
    (<class 'float'>, <class 'NoneType'>)
    >>> alternatives(Literal["a", "b"])
    ('a', 'b')
    """
    if get_origin(hint) in (Union, types.UnionType):
        return tuple(part for one in get_args(hint) for part in alternatives(one))
    if get_origin(hint) is Annotated:
        return alternatives(get_args(hint)[0])
    return get_args(hint) if get_origin(hint) is Literal else (hint,)


def metadata(field: FieldInfo) -> Iterator[Any]:
    """Yield the metadata of a field and of its alternatives."""
    yield from _flat(field.metadata)
    for hint in (field.annotation, *get_args(field.annotation)):
        if get_origin(hint) is Annotated:
            yield from _flat(get_args(hint)[1:])


def choices(field: FieldInfo) -> tuple[str, ...]:
    """Return the values to which a field is restricted, without none; empty if it takes all of a type."""
    kinds = [kind for kind in alternatives(field.annotation) if kind is not type(None)]
    found: list[str] = []
    for kind in kinds:
        if isinstance(kind, type) and issubclass(kind, Enum):
            found += [str(member.value) for member in kind]
        elif isinstance(kind, type):
            return ()
        else:
            found.append(str(kind))
    return tuple(found)


def _flat(given: Iterable[Any]) -> Iterator[Any]:
    for one in given:
        if isinstance(one, FieldInfo):
            yield from one.metadata
        else:
            yield one
