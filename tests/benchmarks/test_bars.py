"""A bar is met or missed by what was measured."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
CODE = """
import sys
sys.path.insert(0, sys.argv[1])
from measuring.bars import Bar, show
show([
    Bar(what="a", measured=9.0, at_least=8.0),
    Bar(what="b", measured=7.5, at_least=8.0),
    Bar(what="c", measured=2.0, at_most=2.0, unit="s"),
    Bar(what="d", measured=float("nan"), at_most=2.0, note="nothing"),
    Bar(what="e", measured=0.0, at_most=2.0, undecided="too few pairs"),
])
"""


def test_both_kinds_of_bounds_are_judged() -> None:
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(FOLDER)], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines() == [
        "bar: a: ≥ 8 x; measured 9 x: met",
        "bar: b: ≥ 8 x; measured 7.5 x: MISSED by 0.5",
        "bar: c: ≤ 2 s; measured 2 s: met",
        "bar: d: ≤ 2 x; measured nan x (nothing): MISSED by nan",
        "bar: e: ≤ 2 x; measured 0 x: too few pairs",
    ]
