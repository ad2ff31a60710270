"""The command ``cosim``: one file for each sub-command, and what they share."""

from cosim.cli.command_line import main

__all__ = ["main"]
