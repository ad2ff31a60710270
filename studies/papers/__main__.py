"""``python -m studies.papers``: run the papers' experiments without SUMO and print what became of the claims.

    python -m studies.papers                             all papers, into a new folder in runs/
    python -m studies.papers 000 004 --out results/two   two of them

Writes ``claims.csv``, one row per claim, and the figures.

Exit codes: 0 the experiments ran, whatever became of the claims; 2 unknown paper, a folder that is not empty,
or a package that is missing; 3 a file could not be written.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from cosim.errors import InputError, SimulationError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit code."""
    given = _parser().parse_args(arguments)
    try:
        return _run(given.papers, given.out)
    except InputError as error:
        return _tell(str(error), 2)
    except SimulationError as error:
        return _tell(str(error), 3)
    except KeyboardInterrupt:
        return _tell("interrupted", 130)


def _run(papers: Sequence[str], out: Path | None) -> int:
    # After main has begun, so that the number of BLAS threads is set before NumPy is loaded.
    from cosim.cli import terminal
    from cosim.cli.interruption import termination_interrupts
    from cosim.recording import folders
    from studies.papers import catalog, execution, table

    chosen = catalog.chosen(papers)
    folder = folders.create_named(out, "papers")

    def finished(one: catalog.Experiment, seconds: float) -> None:
        print(f"{one.paper} done after {seconds:.0f} s", file=sys.stderr)

    with termination_interrupts():
        claims = execution.execute(chosen, folder, finished)
    console = terminal.console()
    console.print(table.counts(claims, {one.paper: one.title for one in chosen}))
    missed = table.not_reproduced(claims)
    if missed.row_count:
        console.print()
        console.print(missed)
    console.print(f"\nfiles: {folder}", soft_wrap=True)
    return 0


def _tell(text: str, code: int) -> int:
    print(f"papers: {text}", file=sys.stderr)
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.papers",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("papers", nargs="*", metavar="PAPER", help="number of a paper; all of them for none")
    parser.add_argument("--out", type=Path, metavar="DIR", help="empty or new folder for the files")
    return parser


if __name__ == "__main__":
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    sys.exit(main())
