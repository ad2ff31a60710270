"""The error of this package: one line for the user."""

from __future__ import annotations


class ScenarioError(ValueError):
    """A scenario that cannot be found, read or prepared; the text is one line that says what exists."""
