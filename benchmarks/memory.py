"""Whether memory grows in a long run: resident memory over a simulated hour, in a process of its own.

SUMO alone on the same road, in another process, shows what of it is SUMO's.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import json
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import libsumo
from measuring import results
from measuring.bars import Bar, show
from measuring.command import options
from measuring.resident import HOUR_S, Looks, in_process, settled, slope
from measuring.solvers import DEFAULT

from cosim.running.request import RunRequest
from cosim.running.simulation import run
from sumo_scenarios import library

SCENARIO, CONTROLLER, SEED = "midblock_zebra", "vo_mpc", 1
SETTINGS = {"step_s": "0.5", "warmup_s": "120", "vehicles_per_hour": "400", "pedestrians_per_hour": "200"}
"""A long step and thin traffic: an hour in about a minute."""
EGO_SHARE = 0.2
SETTLED_S = 900.0
"""From here on memory is what it is: the road is full, and everything has been needed once."""
MOST_MB_PER_HOUR = 20.0


def watched(duration_s: float, solver: str) -> dict[str, list[float]]:
    """Run, and return resident memory [MB] over simulated time [s]."""
    looks = Looks()
    settings = {**SETTINGS, "solver": solver}
    with TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        run(
            RunRequest(
                SCENARIO, CONTROLLER, SEED, settings, duration_s=duration_s, ego_share=EGO_SHARE, out=out
            ),
            lambda now, end: looks.look(now),
        )
    return looks.found


def watched_alone(duration_s: float) -> dict[str, list[float]]:
    """Let SUMO step by itself through the same demand, and return the same."""
    looks = Looks()
    scenario, _ = library.with_parameters(library.load(SCENARIO), {**SETTINGS, "duration_s": f"{duration_s}"})
    with TemporaryDirectory() as folder:
        libsumo.start(["sumo", *library.prepare(scenario, SEED, Path(folder)).options])
        try:
            while (now := libsumo.simulation.getTime()) < duration_s:
                libsumo.simulationStep()
                if now >= scenario.warmup_s:
                    looks.look(now)
        finally:
            libsumo.close()
    return looks.found


def main() -> None:
    """Measure, print and publish."""
    if sys.argv[1:2] == ["--watch"]:
        print(json.dumps(watched(float(sys.argv[2]), sys.argv[3])))
        return
    if sys.argv[1:2] == ["--watch-alone"]:
        print(json.dumps(watched_alone(float(sys.argv[2]))))
        return
    given = options(__doc__)
    duration_s, settled_s = (300.0, 150.0) if given.quick else (HOUR_S, SETTLED_S)
    solver = DEFAULT
    began = time.perf_counter()
    seen = in_process(__file__, "--watch", f"{duration_s}", solver)
    took_s = time.perf_counter() - began
    times, sizes = settled(seen, settled_s)
    alone = settled(in_process(__file__, "--watch-alone", f"{duration_s}"), settled_s)
    found: dict[str, Any] = {
        "scenario": SCENARIO,
        "controller": CONTROLLER,
        "solver": solver,
        "settings": SETTINGS,
        "simulated_s": duration_s,
        "settled_s": settled_s,
        "took_s": took_s,
        "mb_per_hour": slope(times, sizes),
        "settled_mb": sizes[0],
        "end_mb": sizes[-1],
        "alone_mb_per_hour": slope(*alone),
        "alone_end_mb": alone[1][-1],
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
            note=f"{found['alone_mb_per_hour']:+.1f} MB/h is SUMO alone on the same road",
        )
    ]
    show(bars)
    results.publish("memory", found, bars, given.folder)


if __name__ == "__main__":
    main()
