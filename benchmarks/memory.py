"""Whether memory grows in a long run: resident memory over a simulated hour, in a process of its own."""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import json
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import psutil
from measuring import results
from measuring.bars import Bar, show
from measuring.command import options
from measuring.solvers import solvers

from cosim.request import RunRequest
from cosim.run import run

SCENARIO, CONTROLLER = "midblock_zebra", "vo_mpc"
HOUR_S = 3600.0
SETTINGS = {"step_s": "0.5", "warmup_s": "120", "vehicles_per_hour": "400", "pedestrians_per_hour": "200"}
"""A long step and thin traffic: an hour in about a minute."""
EGO_SHARE = 0.2
EVERY_S = 30.0
SETTLED_S = 900.0
"""From here on memory is what it is: the road is full, and everything has been needed once."""
MOST_MB_PER_HOUR = 20.0


def watched(duration_s: float, solver: str) -> dict[str, list[float]]:
    """Run, and return resident memory [MB] over simulated time [s]."""
    process = psutil.Process()
    found: dict[str, list[float]] = {"time_s": [], "resident_mb": []}

    def look(now: float, end: float) -> None:
        if not found["time_s"] or now - found["time_s"][-1] >= EVERY_S - 1e-6:
            found["time_s"].append(now)
            found["resident_mb"].append(process.memory_info().rss / 1e6)

    settings = {**SETTINGS, "solver": solver}
    with TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        run(
            RunRequest(
                SCENARIO, CONTROLLER, 1, settings, duration_s=duration_s, ego_share=EGO_SHARE, out=out
            ),
            look,
        )
    return found


def slope(times_s: Sequence[float], sizes_mb: Sequence[float]) -> float:
    """Return the slope of the straight line that fits best [MB/h]."""
    return HOUR_S * float(np.polyfit(times_s, sizes_mb, 1)[0])


def main() -> None:
    """Measure, print and publish."""
    if sys.argv[1:2] == ["--watch"]:
        print(json.dumps(watched(float(sys.argv[2]), sys.argv[3])))
        return
    given = options(__doc__)
    duration_s, settled_s = (300.0, 150.0) if given.quick else (HOUR_S, SETTLED_S)
    solver = solvers()[-1]
    began = time.perf_counter()
    command = [sys.executable, __file__, "--watch", str(duration_s), solver]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"the run ended with {done.returncode}")
    seen = json.loads(done.stdout.splitlines()[-1])
    later = [i for i, now in enumerate(seen["time_s"]) if now >= settled_s]
    times, sizes = ([seen[key][i] for i in later] for key in ("time_s", "resident_mb"))
    found: dict[str, Any] = {
        "scenario": SCENARIO,
        "controller": CONTROLLER,
        "solver": solver,
        "settings": SETTINGS,
        "simulated_s": duration_s,
        "settled_s": settled_s,
        "took_s": time.perf_counter() - began,
        "mb_per_hour": slope(times, sizes),
        "settled_mb": sizes[0],
        "end_mb": sizes[-1],
        **seen,
    }
    print(
        f"{SCENARIO}, {CONTROLLER} with {solver}: {sizes[0]:.0f} MB after {settled_s:g} s, "
        f"{sizes[-1]:.0f} MB after {duration_s:g} s"
    )
    bars = [
        Bar(
            what=f"growth of resident memory over {duration_s:g} simulated seconds",
            measured=found["mb_per_hour"],
            at_most=MOST_MB_PER_HOUR,
            unit="MB/h",
        )
    ]
    show(bars)
    results.publish("memory", found, bars, given.folder)


if __name__ == "__main__":
    main()
