"""``python -m studies.architecture FOLDER`` writes ``rooms.svg`` and ``step.svg`` (``make pictures``)."""

from __future__ import annotations

import argparse
from pathlib import Path

from analysis.files import write_text
from cosim.step import loop
from studies.architecture import rooms_picture, step_picture
from studies.architecture.rooms import read_house
from studies.architecture.step import read_step

PROJECT = Path(__file__).resolve().parents[2]


def pictures() -> dict[str, str]:
    """Return the pictures of the code as it is, by file name."""
    return {
        "rooms.svg": rooms_picture.draw(read_house(PROJECT)),
        "step.svg": step_picture.draw(read_step(loop)),
    }


def main() -> None:
    """Write the pictures and print their paths."""
    parser = argparse.ArgumentParser(description="Draw the architecture from the code as it is.")
    parser.add_argument("folder", type=Path, help="where the pictures go")
    folder: Path = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, picture in pictures().items():
        print(write_text(folder / name, picture))


if __name__ == "__main__":
    main()
