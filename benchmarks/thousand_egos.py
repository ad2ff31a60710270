"""A thousand egos among 2000 vehicles and 1000 persons: measured on one core, extrapolated to four.

Run by hand: ``python benchmarks/thousand_egos.py [EGOS VEHICLES PERSONS]``; it takes some minutes. Times are
processor time of one process. To decide and plan for one ego does not depend on the others, so that with
controllers in four processes that part would be a quarter at best; everything else stays in one process. What
it costs to hand over what egos are told, and their plans, is not measured and not in it.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import math
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from many_egos import PARTS, SEED, share_of
from measuring import loop_with_sumo, stopwatch
from measuring.city import BLOCKS, City
from measuring.loop_with_sumo import CONTROL, drive

from analysis.markdown import table
from cosim.running.request import RunRequest

EGOS, VEHICLES, PERSONS = 1000, 2000, 1000
DENSITY = 400 / BLOCKS**2
"""Vehicles for each junction, as in the city of ``many_egos.py``."""
ALL_THERE_S, DRIVEN_S = 2.0, 0.8
"""All have just set out when measuring begins: to fill the city as slowly as elsewhere takes minutes [s]."""
CORES = 4


def measured(egos: int, vehicles: int, persons: int) -> tuple[float, dict[str, float], float]:
    """Return the mean number of egos, the processor time of a step by part [ms], and that of a whole step."""
    loop_with_sumo.perf_counter = stopwatch.perf_counter = process_time  # type: ignore[attr-defined]
    blocks = max(2, math.ceil(math.sqrt(vehicles / DENSITY)))
    city = City(vehicles, persons, ALL_THERE_S + DRIVEN_S, blocks=blocks, filled_s=ALL_THERE_S)
    with TemporaryDirectory() as folder:
        configuration = str(city.write(Path(folder)))
        share = share_of(egos, vehicles)
        request = RunRequest(configuration, "vo_mpc", SEED, actuation="hybrid", ego_share=share)
        found = drive(request, ALL_THERE_S)
    return float(np.mean(found.egos)), found.mean_ms(PARTS), 1e3 * found.wall_s / found.steps


def main() -> None:
    """Print the table."""
    egos, vehicles, persons = (
        (int(word) for word in sys.argv[1:4]) if sys.argv[1:] else (EGOS, VEHICLES, PERSONS)
    )
    driven, parts, whole = measured(egos, vehicles, persons)
    rows = [
        ("decide and plan" if part == CONTROL else part, f"{value:.0f}", f"{value / driven:.3f}")
        for part, value in parts.items()
    ]
    rows.append(("everything", f"{whole:.0f}", f"{whole / driven:.3f}"))
    print(
        table((f"{driven:.0f} egos, {vehicles} vehicles, {persons} persons", "ms a step", "ms per ego"), rows)
    )
    step_ms = 100.0
    on_more = whole - parts[CONTROL] * (1.0 - 1.0 / CORES)
    print(f"one core, measured: {step_ms / whole:.2f} x real time (steps of 0.1 s)")
    print(
        f"{CORES} cores, extrapolated: {on_more:.0f} ms a step, {step_ms / on_more:.2f} x real time at best"
    )


if __name__ == "__main__":
    main()
