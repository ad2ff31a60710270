"""``python -m studies.solvers.page FOLDER``: what the choice of a solver changes in closed loop.

FOLDER holds the batches of ``solvers.toml`` and ``solvers_paper.toml``, which lie beside this file; the table
is printed as Markdown, for docs/performance.md.
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

import pandas as pd

from analysis.files import read_json
from analysis.manifest import read_verified
from analysis.markdown import table_of


def read(folder: Path) -> pd.DataFrame:
    """Return one row for each finished run of a batch.

    Raises
    ------
    SystemExit
        If the folder holds no finished run.
    """
    rows = []
    for path in sorted(folder.rglob("run.json")):
        about = read_json(path)
        if not about["valid"]:
            continue
        run = pd.read_csv(BytesIO(read_verified(path.with_name("runs.csv")))).iloc[0]
        # Take the solver that the run counted, not the one that was requested.
        (solver, solves), *others = about["solvers"].items()
        assert not others, f"{path}: several solvers ran"
        rows.append(
            {
                "controller": about["controller"],
                "solver": solver,
                "programs": solves["programs"],
                "unsolved": solves["unsolved"],
                "entered": run["n_entered"],
                "contacts": run["n_collisions"],
                "egos": run["ego_count"],
                "delay_s": run["ego_delay_mean_s"],
                "steps": run["n_plans"],
                "unsolved_steps": run["n_solver_fail"],
                "p50": run["compute_p50_ms"],
                "p95": run["compute_p95_ms"],
                "p99": run["compute_p99_ms"],
            }
        )
    if not rows:
        raise SystemExit(f"{folder}: no finished run")
    return pd.DataFrame(rows)


def lines(runs: pd.DataFrame) -> list[dict[str, str]]:
    """Return a table row for each controller and solver; times are medians over the runs."""
    found = []
    for (controller, solver), group in runs.groupby(["controller", "solver"]):
        total = group.sum(numeric_only=True)
        delay = (group["delay_s"] * group["egos"]).sum() / total["egos"]
        found.append(
            {
                "controller": str(controller),
                "solver": str(solver),
                "runs": str(len(group)),
                "entered encounters": f"{total['entered']:.0f}",
                "contacts": f"{total['contacts']:.0f}",
                "mean delay s": f"{delay:.2f}",
                "programs": f"{total['programs']:.0f}",
                "unsolved": f"{total['unsolved']:.0f} ({total['unsolved'] / total['programs']:.2%})",
                "fallback steps": f"{total['unsolved_steps'] / total['steps']:.2%}",
                "step median ms": f"{group['p50'].median():.2f}",
                "p95 ms": f"{group['p95'].median():.2f}",
                "p99 ms": f"{group['p99'].median():.2f}",
            }
        )
    return found


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print(table_of(lines(read(Path(sys.argv[1])))))
