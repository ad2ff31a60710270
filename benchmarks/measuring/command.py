"""What every benchmark takes on its command line."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

from measuring.results import FOLDER


@dataclass(frozen=True, slots=True)
class Options:
    """How a benchmark runs."""

    quick: bool
    """As little as shows that it works; the numbers say nothing."""
    folder: Path | None
    """Where results go; ``None``: nowhere."""


def options(about: str | None) -> Options:
    """Read the command line; quick results go nowhere unless a folder is given."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="only show that it works")
    parser.add_argument("--out", type=Path, help="folder for results.json and results.md")
    given = parser.parse_args()
    return Options(given.quick, given.out or (None if given.quick else FOLDER))
