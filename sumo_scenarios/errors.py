"""The error of this package: one line for the user."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class ScenarioError(ValueError):
    """A scenario that cannot be found, read or prepared; the text is one line that says what exists."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a question that names the known name nearest to a wrong one, or nothing if none is near.

    >>> did_you_mean("horizn", ["horizon", "solver"])
    "did you mean 'horizon'? "
    """
    near = difflib.get_close_matches(name, list(known), n=1)
    return f"did you mean {near[0]!r}? " if near else ""
