"""``make demo``: three controllers on one scenario and seed. ``python -m cosim.cli.demo [SEED]``."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cosim.presentation.numbers import Row

SCENARIO = "midblock_zebra"
CONTROLLERS = ("vo_mpc", "sumo", "aeb")
BASELINE = "sumo"
NEXT = (
    "  source .venv/bin/activate                 the command cosim, in this terminal",
    "  cosim list scenarios                      what else there is to drive through, and its parameters",
    "  cosim run midblock_unmarked --seed 2      one run",
    "  cosim batch studies/crossing_safety.toml --dry-run",
    "                                            many runs: one seed is an anecdote",
    "  docs/own-controller.md, docs/own-network.md  your own car, your own town",
)


def main(seed: int = 1) -> int:
    """Run the controllers, print the comparison, write the report and say where the files are."""
    from cosim.cli import terminal
    from cosim.cli.progress import shown_progress
    from cosim.errors import CosimError
    from cosim.presentation.numbers import comparison_table
    from cosim.presentation.page import write_page
    from cosim.running.execution import Outcome, execute
    from cosim.running.request import RunRequest

    console = terminal.console()
    outcomes: dict[str, Outcome] = {}
    begun = monotonic()
    print(
        f"{len(CONTROLLERS)} runs of the same traffic, each with another controller; about a minute in all. "
        "Their progress follows.",
        file=sys.stderr,
        flush=True,
    )
    for number, controller in enumerate(CONTROLLERS, 1):
        print(f"run {number} of {len(CONTROLLERS)} …", file=sys.stderr, flush=True)
        console.print(f"cosim run {SCENARIO} --controller {controller} --seed {seed}")
        try:
            with shown_progress() as progress:
                outcomes[controller] = execute(RunRequest(SCENARIO, controller, seed), progress)
        except CosimError as error:
            print(f"cosim: {error}", file=sys.stderr)
            return 2
    rows = {name: outcome.row for name, outcome in outcomes.items() if outcome.row is not None}
    console.print()
    title = f"{SCENARIO}, seed {seed}, the same demand for all"
    console.print(comparison_table(rows, title, _derived(rows)))
    for name, outcome in outcomes.items():
        console.print(f"{name}: {outcome.folder}/encounters.csv, {outcome.folder}/runs.csv", soft_wrap=True)
        if outcome.invalid_reason:
            print(f"cosim: {name}: the run is invalid: {outcome.invalid_reason}", file=sys.stderr)
    try:
        page, *_ = write_page([outcome.folder for outcome in outcomes.values()])
    except CosimError as error:
        print(f"cosim: no report: {error}", file=sys.stderr)
    else:
        console.print(
            f"\nThe report, with replays of the encounters, opens in a browser: {page}", soft_wrap=True
        )
    print(f"done after {monotonic() - begun:.0f} s", file=sys.stderr)
    console.print("\n".join(["", "What to try next:", *NEXT]), soft_wrap=True)
    return 3 if any(outcome.invalid_reason for outcome in outcomes.values()) else 0


def _derived(rows: Mapping[str, Row]) -> dict[str, list[str]]:
    """Return the lines of the table that are made of several columns, one text per controller."""
    from cosim.presentation.numbers import number

    base = number(rows[BASELINE], "ego_delay_mean_s") if BASELINE in rows else None
    shares, differences = [], []
    for row in rows.values():
        entered, near = number(row, "n_entered"), number(row, "n_ttc_lt_1p5")
        shares.append("–" if not entered or near is None else f"{100.0 * near / entered:.1f} %")
        delay = number(row, "ego_delay_mean_s")
        differences.append("–" if delay is None or base is None else f"{delay - base:+.1f}")
    return {
        "share of entered encounters with TTC < 1.5 s": shares,
        f"mean delay against {BASELINE}, same seed [s]": differences,
    }


if __name__ == "__main__":
    # Before NumPy is loaded: several BLAS threads make small problems slower, not faster.
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    sys.exit(main(*(int(text) for text in sys.argv[1:2])))
