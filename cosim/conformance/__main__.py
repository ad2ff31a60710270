"""Run all cases for the docs: ``python -m cosim.conformance --out FILE`` writes the table as Markdown."""

from __future__ import annotations

import sys
from pathlib import Path

from cosim.conformance.suite import cases, run
from cosim.conformance.table import markdown, summary


def main(arguments: list[str]) -> int:
    """Run all cases and write the table; return 1 if a case is not green, else 0."""
    _, out = arguments
    results = run(cases(), jobs=2)
    Path(out).write_text(markdown(results), encoding="utf-8")
    print(summary(results))
    return 0 if all(result.green for result in results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
