"""CPU time of analysing recorded runs, and which share of the simulating that is.

``python -m benchmarks.analysis_speed RUN_DIR...`` measures recorded runs in place (their report is written
again); without folders, a made-up run of 4 egos, 20 pedestrians and 40 vehicles over 120 s at 0.1 s.
"""

from __future__ import annotations

import math
import statistics
import sys
import tempfile
from pathlib import Path
from time import process_time

from analysis.encounters.case import prepare
from analysis.markdown import table_of
from analysis.recording.reading import read_run
from analysis.results.analyse import analyse_run
from tests.analysis.recorded import Ego, Motion, Person, Vehicle, line, write_run

REPEATS = 5
_CROSSINGS = tuple(
    {
        "name": f"zebra{number}",
        "kind": "crossing",
        "crossing_kind": "zebra",
        "width_m": 4.0,
        "shape_m": [[220.0 * number, -10.0], [220.0 * number, 10.0]],
    }
    for number in range(6)
)


def made_up_run(folder: Path) -> Path:
    """Write a run of the size that METRICS' bar is about."""
    egos = [Ego(line(-60.0 * number, 0.0, 10.0, 0.0), name=f"ego{number}") for number in range(4)]
    persons = [
        Person(_to_and_fro(number), name=f"ped{number:02d}", crossing=f"zebra{number % 6}")
        for number in range(20)
    ]
    vehicles = [
        Vehicle(line(-200.0 + 30.0 * number, 3.2 * (1 + number % 2), 9.0, 0.0), name=f"car{number:02d}")
        for number in range(40)
    ]
    return write_run(folder, egos, persons, vehicles, duration=120.0, areas=_CROSSINGS, wall_s=None)


def _to_and_fro(number: int) -> Motion:
    def at(t: float) -> tuple[float, float]:
        phase = (1.3 * t + 3.0 * number) % 40.0
        return 220.0 * (number % 6) + 0.15 * number, 10.0 - abs(phase - 20.0)

    return at


def measure(folder: Path) -> dict[str, object]:
    """Return one row of the table."""
    spent = []
    for _ in range(REPEATS):
        started = process_time()
        report = analyse_run(folder)
        spent.append(process_time() - started)
    median = statistics.median(spent)
    pairs = len(prepare(read_run(folder)).samples)
    wall = report.run.get("wall_s")
    share = f"{100.0 * median / float(wall):.1f} %" if wall else "not simulated"
    duration = report.run.get("duration_s") or math.nan
    return {
        "run": folder.name,
        "simulated s": f"{duration:.0f}",
        "encounters": report.run["n_encounters"],
        "sample pairs": pairs,
        "analysis ms": f"{1000.0 * median:.0f}",
        "pairs per s": f"{pairs / median:,.0f}",
        "of the run's time": share,
    }


def main() -> None:
    """Print the table."""
    folders = [Path(name) for name in sys.argv[1:]]
    with tempfile.TemporaryDirectory() as name:
        print(table_of([measure(folder) for folder in folders or [made_up_run(Path(name) / "made_up")]]))


if __name__ == "__main__":
    main()
