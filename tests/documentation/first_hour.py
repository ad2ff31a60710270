"""How long a newcomer waits for the machine: the commands of a page as they stand, one after the other.

``python -m tests.documentation.first_hour`` does it for a network and a controller of one's own, each in an empty
folder, and prints wall and processor time of every command; with arguments, it does so for these pages.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import sumo

from tests.documentation import command_blocks, reductions

PAGES = ("docs/first-network.md", "docs/own-controller.md")
LEFT_OUT = (("cosim", "check", "suite:"),)
"""A test protocol is more than a first look."""


@dataclass(frozen=True, slots=True)
class Timed:
    """One command and what it took."""

    command: str
    wall_s: float
    cpu_s: float
    """Of all its processes."""


def timed(commands: Sequence[Sequence[str]], folder: Path) -> Iterator[Timed]:
    """Run commands in a folder.

    Raises
    ------
    subprocess.CalledProcessError
        For the first one that fails.
    """
    # What a shell finds after the activation of the environment.
    programs = os.pathsep.join([str(Path(sys.executable).parent), str(Path(sumo.SUMO_HOME) / "bin")])
    places = os.pathsep.join([str(command_blocks.ROOT), str(folder)])
    environment = {**os.environ, "PATH": programs + os.pathsep + os.environ["PATH"], "PYTHONPATH": places}
    environment["COSIM_CACHE_DIR"] = str(folder / ".cache")  # nothing is there yet, as with a newcomer
    for words in commands:
        begun, used = time.perf_counter(), _used()
        subprocess.run(words, cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL)
        yield Timed(" ".join(words), time.perf_counter() - begun, _used() - used)


def _used() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return children.ru_utime + children.ru_stime


def of_page(page: str) -> list[list[str]]:
    """Return the commands that a newcomer types."""
    return [
        one.words
        for one in command_blocks.of_page(page)
        if not one.excuse and not any(reductions.begins(one.words, start) for start in LEFT_OUT)
    ]


def main(pages: Sequence[str]) -> None:
    """Print a table for each page, a row as soon as its command has ended."""
    for page in pages:
        print(
            f"{page}\n\n| command | wall [s] | processor [s] | processor so far [s] |\n|---|---|---|---|",
            flush=True,
        )
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            reductions.prepare(page, folder, slow=False)
            cpu = 0.0
            for one in timed(of_page(page), folder):
                cpu += one.cpu_s
                row = (f"`{one.command[:70]}`", f"{one.wall_s:.1f}", f"{one.cpu_s:.1f}", f"{cpu:.1f}")
                print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:] or PAGES)
