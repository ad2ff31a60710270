"""``cosim papers``: where the papers' experiments are, for those who know the command of earlier versions."""

from __future__ import annotations

from cosim.errors import InputError

ANYTHING = {"ignore_unknown_options": True, "allow_extra_args": True, "help_option_names": []}
"""Settings of the command line: the same answer, whatever is typed behind the name."""


def papers() -> None:
    """Say where the experiments are."""
    raise InputError(
        "the papers' experiments are no longer a command; in a checkout of the repository: make papers"
    )
