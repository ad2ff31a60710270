"""``python -m cosim.suites NAME --controller X --out DIR``: run a test protocol and show the verdicts."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

ALL = "all"
"""Instead of a name: every suite, or every controller."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run it and return the exit code: 0 passed, 1 a preventable case failed, 2 bad input, 3 a bad run."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    from cosim.errors import InputError, SimulationError
    from cosim.running import inventory
    from cosim.suites import judging

    parser = argparse.ArgumentParser(prog="python -m cosim.suites", description="Run test protocols.")
    parser.add_argument("suite", metavar="NAME", help=f"{', '.join(judging.names())}; NAME/CASE; or {ALL}")
    parser.add_argument("--controller", action="append", metavar="NAME", help=f"repeatable, or {ALL}")
    parser.add_argument("--only", default="", metavar="PATTERN", help="cases or groups, * for anything")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed there")
    parser.add_argument("--jobs", type=int, metavar="N", help="runs at a time; default: one a core")
    asked = parser.parse_args(arguments)
    controllers = asked.controller or ["vo_mpc"]
    if controllers == [ALL]:
        controllers = [entry.name for entry in inventory.controllers()]
    suites = judging.names() if asked.suite == ALL else (asked.suite,)
    code = 0
    try:
        for suite in suites:
            out = asked.out / suite if asked.suite == ALL else asked.out
            code = max(code, _run(suite, asked.only, controllers, out, asked.jobs))
    except (InputError, SimulationError) as error:
        print(f"cosim: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 3
    return code


def _run(suite: str, only: str, controllers: Sequence[str], out: Path, jobs: int | None) -> int:
    from cosim.suites import judging
    from cosim.suites.running import run_cases

    cases = judging.cases(suite, only)
    finished = run_cases(cases, controllers, out, jobs)
    for row in finished.rows:
        verdict = row.verdict
        state = "invalid" if verdict is None else "pass" if verdict.passed else "fail"
        if verdict is not None and not verdict.passed and not verdict.counts:
            state = "unpreventable"
        note = row.note if verdict is None else verdict.note
        print(f"{row.controller:22} {row.case:32} {state:13} {note}".rstrip())
    print(f"\n{judging.label(cases[0].suite)}: {out / 'protocol.csv'}")
    return finished.exit_code


if __name__ == "__main__":
    sys.exit(main())
