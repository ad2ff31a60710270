"""Without the command line of ``cosim``, for the suite's own processes and for the page in docs.

``python -m cosim.conformance CASE claim|control FILE`` measures one side of one case in this process.
``python -m cosim.conformance --out FILE`` runs all cases and writes the table as Markdown.
"""

from __future__ import annotations

import sys
from pathlib import Path

from cosim.conformance.suite import cases, run, serve
from cosim.conformance.table import markdown, summary


def main(arguments: list[str]) -> int:
    """Do either; the exit code is 1 if a case is not green."""
    if arguments[:1] != ["--out"]:
        key, side, output = arguments
        serve(key, side, Path(output))
        return 0
    results = run(cases(), jobs=2)
    Path(arguments[1]).write_text(markdown(results), encoding="utf-8")
    print(summary(results))
    return 0 if all(result.green for result in results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
