"""Results that are asked for several times in a step, by parts that do not know of each other."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

Given = ParamSpec("Given")
Result = TypeVar("Result")


def remembered(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Return the function with its last result kept, and given again for the very same objects.

    The objects are what an ego is told in a step, which nobody changes; others that are equal are worked out
    anew. What is returned must not be changed either.

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
