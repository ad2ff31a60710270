"""What many egos cost that plan at every step, and only where something can change the plan, side by side.

Run by hand: ``python benchmarks/many_egos_seldom.py [EGOS]``. Both alternate, each run in a process of its
own; times are processor time, which other programs change less than wall time.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from many_egos import PARTS, PERSONS, SEED, VEHICLES, share_of
from measuring import loop_with_sumo, stopwatch
from measuring.city import FILLED_S, City
from measuring.loop_with_sumo import CONTROL, drive

from analysis.markdown import table
from cosim.running.request import RunRequest

DRIVEN_S = 4.0
ROUNDS = 3
INTERVALS = ("0", "0.5")
"""Time between plans while nothing can change them [s]; 0: a plan at every step."""
EVERYTHING = "everything"


def measured(configuration: str, share: float, interval: str) -> dict[str, float]:
    """Return the processor time per ego and step, by part [ms]."""
    loop_with_sumo.perf_counter = stopwatch.perf_counter = process_time  # type: ignore[attr-defined]
    settings = {"idle_interval_s": interval}
    request = RunRequest(configuration, "vo_mpc", SEED, settings, actuation="hybrid", ego_share=share)
    found = drive(request, FILLED_S)
    egos = float(np.mean(found.egos))
    parts = {part: value / egos for part, value in found.mean_ms(PARTS).items()}
    return {**parts, EVERYTHING: 1e3 * found.wall_s / found.steps / egos}


def main() -> None:
    """Print the table."""
    if sys.argv[1:2] == ["--drive"]:
        print(json.dumps(measured(sys.argv[2], float(sys.argv[3]), sys.argv[4])))
        return
    egos = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    runs: dict[str, list[dict[str, float]]] = {interval: [] for interval in INTERVALS}
    with TemporaryDirectory() as folder:
        city = City(VEHICLES, PERSONS, duration_s=FILLED_S + DRIVEN_S)
        given = [str(city.write(Path(folder))), str(share_of(egos, VEHICLES))]
        for interval in INTERVALS * ROUNDS:
            command = [sys.executable, __file__, "--drive", *given, interval]
            done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
            runs[interval].append(json.loads(done.stdout.splitlines()[-1]))
    rows = []
    for part in (*PARTS, EVERYTHING):
        every, seldom = (float(np.median([run[part] for run in runs[interval]])) for interval in INTERVALS)
        name = "decide and plan" if part == CONTROL else part
        rows.append((name, f"{every:.3f}", f"{seldom:.3f}", f"{seldom / every:.2f}"))
    head = (f"{egos} egos, ms per ego and step", "a plan at every step", "`idle_interval_s=0.5`", "ratio")
    print(table(head, rows))


if __name__ == "__main__":
    main()
