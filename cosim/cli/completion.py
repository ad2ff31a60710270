"""``cosim completion``: what a shell needs to complete commands, options and names."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

VARIABLE = "_COSIM_COMPLETE"


class Shell(StrEnum):
    """Shells that can complete."""

    BASH = "bash"
    ZSH = "zsh"
    FISH = "fish"


def prepare() -> None:
    """Let typer answer what a shell asks through `VARIABLE`."""
    from typer._completion_classes import completion_init

    completion_init()


def completion(
    shell: Annotated[Shell, typer.Argument(metavar="bash|zsh|fish", help="Your shell.")],
) -> int:
    """Print the script with which a shell completes commands, options and names.

    \b
    Examples:
      bash, in ~/.bashrc:                     source <(cosim completion bash)
      zsh, in ~/.zshrc, after compinit:       source <(cosim completion zsh)
      fish:  cosim completion fish > ~/.config/fish/completions/cosim.fish
    """
    from typer._completion_shared import get_completion_script

    typer.echo(get_completion_script(prog_name="cosim", complete_var=VARIABLE, shell=shell.value))
    return 0
