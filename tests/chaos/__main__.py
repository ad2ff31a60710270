"""``python -m tests.chaos``: batches that are disturbed and resumed, from a seed; prints how they ended."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.chaos.rounds import Chaos


def main() -> int:
    """Run the rounds and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    began = time.monotonic()
    with TemporaryDirectory(prefix="cosim-chaos-") as folder:
        result = Chaos(Path(folder), arguments.seed).run(arguments.rounds)
    count = result.endings.total()
    print(f"{count} rounds, seed {arguments.seed}, {time.monotonic() - began:.0f} s")
    for (kind, ending), number in sorted(result.endings.items()):
        print(f"  {kind:12} {ending:22} {number}")
    print(f"{count - len(result.wrong)} of {count} with nothing lost and nothing altered unnoticed")
    for line in result.wrong:
        print(f"- {line}")
    return 1 if result.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
