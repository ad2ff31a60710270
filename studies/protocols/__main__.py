"""``python -m studies.protocols NAME --controller X --out DIR``: drive suites and show the verdicts."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

ALL = "all"
"""Selects every suite or every controller, in place of a name."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Drive suites; return 0 if passed, 1 if a preventable case failed, 2 for bad input, 3 for a bad run."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    from cosim.errors import InputError, SimulationError
    from cosim.running import inventory
    from cosim.suites import judging
    from studies.protocols.driving import drive

    parser = argparse.ArgumentParser(prog="python -m studies.protocols", description="Drive test protocols.")
    parser.add_argument("suite", metavar="NAME", help=f"{', '.join(judging.names())}; NAME/CASE; or {ALL}")
    parser.add_argument("--controller", action="append", metavar="NAME", help=f"repeatable, or {ALL}")
    parser.add_argument("--filter", metavar="PATTERN", help="only cases whose name has this in it")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed there")
    parser.add_argument("--jobs", type=int, metavar="N", help="runs at a time; default: one a core")
    asked = parser.parse_args(arguments)
    controllers = asked.controller or ["vo_mpc"]
    if controllers == [ALL]:
        controllers = [entry.name for entry in inventory.controllers()]
    suites = judging.names() if asked.suite == ALL else (asked.suite,)
    try:
        driven = drive(suites, controllers, asked.out, asked.filter, asked.jobs)
    except (InputError, SimulationError) as error:
        print(f"protocols: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 3
    for row in driven.rows:
        verdict = row.verdict
        state = "invalid" if verdict is None else "pass" if verdict.passed else "fail"
        if verdict is not None and not verdict.passed and not verdict.counts:
            state = "unpreventable"
        note = row.note if verdict is None else verdict.note
        print(f"{row.controller:22} {row.case:32} {state:13} {note}".rstrip())
    labels = ", ".join(dict.fromkeys(judging.label(row.suite) for row in driven.rows))
    print(f"\n{labels}: {', '.join(map(str, driven.files))}")
    return driven.exit_code


if __name__ == "__main__":
    sys.exit(main())
