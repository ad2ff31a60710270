"""The error of this package: one line for the user."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from pydantic import ValidationError
from pydantic_core import ErrorDetails


class ScenarioError(ValueError):
    """A scenario that cannot be found, read or prepared; the text is one line that says what exists."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a question that names the known name nearest to a wrong one, or nothing if none is near.

    >>> did_you_mean("horizn", ["horizon", "solver"])
    "did you mean 'horizon'? "
    """
    near = difflib.get_close_matches(name, list(known), n=1)
    return f"did you mean {near[0]!r}? " if near else ""


def most_telling(error: ValidationError) -> ErrorDetails:
    """Return the mistake to report: an unknown key before a missing one, which may be the same, misspelt."""
    found = error.errors(include_url=False)
    return next((one for one in found if one["type"] == "extra_forbidden"), found[0])
