"""Checks whether a change of the code changed results: compares every controller in every scenario.

``make golden`` makes the runs of ``studies/golden.toml``. Then ``python -m studies.golden runs/golden
--against BEFORE`` compares them with those of an earlier commit, by value and column by column, so that files
may gain or reorder columns.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import pandas as pd

FILES = ("egos.parquet", "neighbours.parquet", "plans.parquet", "encounters.csv", "runs.csv")
"""Files of a run that are compared; timing.parquet is not, since computing times vary."""
OF_THE_MACHINE = ("run_id", "config_id", "tool_version", "git_sha", "wall_", "compute_")
"""Prefixes of columns that differ between runs or versions and are ignored."""


def differences(before: Path, after: Path) -> list[str]:
    """Return one line for every file that differs, and for every run that only one side has."""
    known, made = _runs(before), _runs(after)
    lines = [f"{run}: only in {before}" for run in sorted(known.keys() - made.keys())]
    lines += [f"{run}: only in {after}" for run in sorted(made.keys() - known.keys())]
    for run in sorted(known.keys() & made.keys()):
        for name in FILES:
            told = _difference(_table(known[run] / name), _table(made[run] / name))
            if told:
                lines.append(f"{run}/{name}: {told}")
    return lines


def _runs(folder: Path) -> dict[str, Path]:
    """Return a batch's runs by scenario, controller and seed; the rest of a name depends on the version."""
    return {run.name.rpartition("-")[0]: run for run in sorted((folder / "runs").iterdir())}


def _table(file: Path) -> pd.DataFrame:
    if not file.exists():
        return pd.DataFrame()
    table = pd.read_parquet(file) if file.suffix == ".parquet" else pd.read_csv(file)
    return table[[name for name in table.columns if not name.startswith(OF_THE_MACHINE)]]


def _difference(before: pd.DataFrame, after: pd.DataFrame) -> str:
    """Return how a table differs from an earlier one; empty if not. New columns do not count."""
    if len(before) != len(after):
        return f"{len(before)} rows before, {len(after)} after"
    gone = [str(name) for name in before.columns if name not in after.columns]
    if gone:
        return "without " + ", ".join(gone)
    other = [str(name) for name in before.columns if not before[name].equals(after[name])]
    return "other " + ", ".join(other) if other else ""


def main() -> None:
    """Compare two batches; the exit code is 1 if they differ."""
    parser = argparse.ArgumentParser(description="Compare the runs of two versions of the code, by value.")
    parser.add_argument("runs", type=Path, help="folder of a batch")
    parser.add_argument("--against", type=Path, required=True, help="folder of the same batch before")
    given = parser.parse_args()
    lines = differences(given.against, given.runs)
    print("\n".join(lines) or f"the same in all {len(_runs(given.runs))} runs")
    sys.exit(1 if lines else 0)


if __name__ == "__main__":
    main()
