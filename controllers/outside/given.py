"""A controller that a program hands over instead of a name, in the form that runs use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from controllers.interface import Controller


@dataclass(frozen=True, slots=True, eq=False)
class Given:
    """A controller without an entry in the catalogue; ``str`` of it is its name."""

    name: str
    build: Callable[..., Controller]
    """Makes a controller for one ego and one run; its parameters have defaults."""
    source_sha256: str = ""
    """Hash of its source; empty where Python does not know the source."""

    def __str__(self) -> str:
        return self.name
