"""Study files, batches as a user starts them, and what is to be the same however they were run."""

from __future__ import annotations

import csv
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cosim.batches.job import Configuration, Job
from tests.cosim.cli.commands import ended

SHORT = {"warmup_s": 2.0, "duration_s": 6.0}
"""A run of a second or two."""


def write_study(folder: Path, **keys: Any) -> Path:
    """Write a study file; tables are given as mappings."""
    content: dict[str, Any] = {
        "scenarios": ["midblock_zebra"],
        "controllers": ["sumo"],
        "seeds": "1-2",
        "set": SHORT,
        **keys,
    }
    lines = [f"{key} = {_toml(value)}" for key, value in content.items() if not isinstance(value, Mapping)]
    for key, value in content.items():
        if isinstance(value, Mapping):
            lines += [f"[{key}]", *(f"{name} = {_toml(each)}" for name, each in value.items())]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "study.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return repr(value)


def batch(
    *arguments: object,
    code: int = 0,
    folder: Path | None = None,
    environment: Mapping[str, str] | None = None,
) -> subprocess.CompletedProcess[str]:
    """Run a batch to its end, which must have this exit code."""
    return ended("batch", *arguments, code=code, folder=folder, environment=environment)


def refused(*arguments: object, folder: Path | None = None) -> str:
    """Run a batch that must be refused, and return its one line."""
    lines = batch(*arguments, code=2, folder=folder).stderr.strip().splitlines()
    assert len(lines) == 1, lines
    assert lines[0].startswith("cosim: ")
    return lines[0]


def runs(folder: Path) -> list[str]:
    """Return the names of the finished runs."""
    return sorted(path.name for path in (folder / "runs").iterdir())


def rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def lasting(folder: Path, tables: Sequence[str] = ("runs", "encounters", "configs", "comparisons")) -> str:
    """Return the tables of a study without what the wall clock decides."""
    texts = []
    for name in tables:
        found = rows(folder / f"{name}.csv")
        assert found or name in ("encounters", "comparisons"), f"{name}.csv is empty"
        for row in found:
            if not row.get("metric", "").startswith(("wall_", "compute_")):
                texts.append([pair for pair in row.items() if not pair[0].startswith(("wall_", "compute_"))])
    return "\n".join(map(repr, texts))


def content(folder: Path) -> dict[str, object]:
    """Return the files of a run without what the wall clock decides."""
    found: dict[str, object] = {}
    for path in sorted(folder.iterdir()):
        if path.name == "runs.csv":
            (row,) = rows(path)
            found[path.name] = {key: row[key] for key in row if not key.startswith(("wall_", "compute_"))}
        elif path.name not in ("run.json", "timing.parquet", "files.json"):
            found[path.name] = path.read_bytes()
    return found


def some_job(seed: int = 1, controller: str = "sumo", **settings: str) -> Job:
    """Return a short run."""
    pairs = tuple((key, str(value)) for key, value in {**SHORT, **settings}.items())
    one = Configuration("midblock_zebra", "midblock_zebra", "midblock_zebra", controller, pairs, (), ())
    return Job(one, seed)
