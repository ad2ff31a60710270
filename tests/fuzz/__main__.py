"""``python -m tests.fuzz``: many cases from a seed; prints how they ended, and each that did not behave.

Files without a mistake come first: they have to be taken.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.fuzz.running import run_cases


def main() -> int:
    """Run the cases and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for the files of cases that did not behave")
    arguments = parser.parse_args()
    began = time.monotonic()
    with TemporaryDirectory(prefix="cosim-fuzz-") as folder:
        result = run_cases(Path(folder), arguments.cases, arguments.seed, arguments.keep)
    print(f"{result.count} cases, seed {arguments.seed}, {time.monotonic() - began:.0f} s")
    for kind, ending in result.right.items():
        print(f"  without a mistake: {kind}: {ending}")
    for (kind, ending), number in sorted(result.endings.items()):
        print(f"  {kind:12} {ending:10} {number}")
    print(f"{result.count - len(result.wrong)} of {result.count} behaved")
    for case, what, told in result.wrong:
        print(f"- {case.kind} {case.file}: {what}: {told}")
    return 1 if result.wrong or {*result.right.values()} != {"exit 0"} else 0


if __name__ == "__main__":
    sys.exit(main())
