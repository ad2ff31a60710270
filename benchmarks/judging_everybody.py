"""What it costs to record and judge everybody: time against the simulation's, megabytes, and memory.

SUMO's own traffic on the Braunschweig junction; every part runs in a process of its own.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

from measuring import results
from measuring.bars import Bar, show
from measuring.command import options
from measuring.resident import HOUR_S, Looks, in_process, settled, slope

from analysis.recording.columns import TRAFFIC
from analysis.recording.extent import EVERYBODY
from analysis.results.analyse import analyse_run
from cosim.running.request import RunRequest
from cosim.running.simulation import run

SCENARIO, SEED = "braunschweig", 1
DURATION_S = 600.0
SETTLED_S = 54_000.0 + 150.0
"""The junction is full from here on; the scenario begins at 15:00."""
MOST_SHARE, MOST_MB_PER_HOUR, MOST_GROWTH_MB_PER_HOUR = 20.0, 40.0, 20.0


def simulated(folder: Path, duration_s: float) -> dict[str, Any]:
    """Simulate and record in this process; return CPU time [s] and resident memory [MB] over time [s]."""
    looks = Looks()
    request = RunRequest(
        SCENARIO, "sumo", SEED, duration_s=duration_s, ego_share=0.0, record=EVERYBODY, out=folder
    )
    began = process_time()
    run(request, lambda now, end: looks.look(now))
    return {"cpu_s": process_time() - began, **looks.found}


def judged(folder: Path) -> dict[str, Any]:
    """Judge a recorded run in this process; return CPU time [s] and the most memory [MB].

    Libraries are loaded before: a worker process loads them once for many runs.
    """
    import pandas  # noqa: F401

    began = process_time()
    analyse_run(folder)
    return {"cpu_s": process_time() - began, "most_mb": Looks.most_mb()}


def measured(duration_s: float) -> dict[str, Any]:
    """Return the numbers of the section."""
    with TemporaryDirectory() as place:
        folder = Path(place) / "run"
        made = in_process(__file__, "--simulate", str(folder), str(duration_s))
        found = in_process(__file__, "--judge", str(folder))
        recorded = (folder / TRAFFIC.file).stat().st_size / 1e6
    times, sizes = settled(made, SETTLED_S)
    return {
        "scenario": SCENARIO,
        "simulated_s": duration_s,
        "simulation_cpu_s": made["cpu_s"],
        "judging_cpu_s": found["cpu_s"],
        "share_percent": 100.0 * found["cpu_s"] / made["cpu_s"],
        "mb_per_hour": recorded * HOUR_S / duration_s,
        "growth_mb_per_hour": slope(times, sizes) if len(times) > 1 else 0.0,
        "judging_most_mb": found["most_mb"],
        "time_s": made["time_s"],
        "resident_mb": made["resident_mb"],
    }


def bars(found: dict[str, Any]) -> list[Bar]:
    """Return what is asked of the numbers."""
    return [
        Bar(
            what="judging everybody over simulating, Braunschweig, processor time",
            measured=found["share_percent"],
            at_most=MOST_SHARE,
            unit="%",
        ),
        Bar(
            what="recording of everybody, Braunschweig, every 0.1 s",
            measured=found["mb_per_hour"],
            at_most=MOST_MB_PER_HOUR,
            unit="MB/h",
        ),
        Bar(
            what="growth of resident memory while everybody is recorded",
            measured=found["growth_mb_per_hour"],
            at_most=MOST_GROWTH_MB_PER_HOUR,
            unit="MB/h",
            note="SUMO's own included; of so short a run the slope is uncertain",
        ),
    ]


def main() -> None:
    """Measure, print and publish."""
    if sys.argv[1:2] == ["--simulate"]:
        print(json.dumps(simulated(Path(sys.argv[2]), float(sys.argv[3]))))
        return
    if sys.argv[1:2] == ["--judge"]:
        print(json.dumps(judged(Path(sys.argv[2]))))
        return
    given = options(__doc__)
    found = measured(20.0 if given.quick else DURATION_S)
    asked = bars(found)
    print(
        f"{found['simulated_s']:g} s: simulating {found['simulation_cpu_s']:.1f} s, judging "
        f"{found['judging_cpu_s']:.1f} s and at most {found['judging_most_mb']:.0f} MB"
    )
    show(asked)
    results.publish("judging_everybody", found, asked, given.folder)


if __name__ == "__main__":
    main()
