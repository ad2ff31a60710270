"""All bars of the last `make bench`, with the measured values beside them."""

from __future__ import annotations

import json

from measuring.bars import line
from measuring.results import FOLDER, all_bars


def main() -> None:
    """Print them, and how many are missed."""
    bars = all_bars(json.loads((FOLDER / "results.json").read_text(encoding="utf-8")))
    for bar in bars:
        print(line(bar))
    missed = sum(bar["verdict"].startswith("MISSED") for bar in bars)
    undecided = sum(bar["verdict"] != "met" for bar in bars) - missed
    print(
        f"{len(bars)} bars, {missed} missed, {undecided} undecided; numbers are in {FOLDER.name}/results.md"
    )


if __name__ == "__main__":
    main()
