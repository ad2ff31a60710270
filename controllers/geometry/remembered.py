"""Results that independent parts of the program need several times in one step."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

Given = ParamSpec("Given")
Result = TypeVar("Result")


def remembered(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Return the function with its last result kept, to be returned again for the very same objects.

    The objects are those that an ego is told in a step; nobody changes them. For equal but different objects
    the result is computed anew. The result must not be changed either.

    Examples
    --------
    >>> squares = remembered(lambda numbers: [number**2 for number in numbers])
    >>> some = [1, 2]
    >>> squares(some) is squares(some), squares(some) is squares([1, 2])
    (True, False)
    """
    kept: list[tuple[tuple[Any, ...], Result]] = []

    @wraps(function)
    def ask(*given: Given.args, **named: Given.kwargs) -> Result:
        if not named and kept and len(kept[0][0]) == len(given):
            for one, other in zip(kept[0][0], given, strict=True):
                if one is not other:
                    break
            else:
                return kept[0][1]
        result = function(*given, **named)
        kept[:] = [] if named else [(given, result)]
        return result

    return ask
