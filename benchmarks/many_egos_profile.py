"""Where the time of a hundred egos goes: shares of a profile of the loop, by part.

Run by hand: ``python benchmarks/many_egos_profile.py [EGOS]``. A profiler makes small calls dearer, so that
the shares are rough; the times without it are those of ``many_egos.py``.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import cProfile
import pstats
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from many_egos import PERSONS, SEED, VEHICLES, share_of
from measuring.city import FILLED_S, City
from measuring.loop_with_sumo import drive

from analysis.markdown import table
from cosim.running.request import RunRequest

DRIVEN_S = 3.0
LOOP = ("cosim/step/loop.py", "_drive")
PARTS = {
    "controllers: plan": ("mpc/driver.py", "plan"),
    "of it solving and certifying programs": ("optimisation/solve.py", "solve"),
    "of it the last check": ("safety/last_check.py", "checked"),
    "controllers: decide": ("mpc/driver.py", "decide"),
    "world: sense": ("cosim/sumo/world.py", "sense"),
    "of it the road ahead, signals and foes": ("cosim/sumo/sensing.py", "_road"),
    "of it everybody near, all egos at once": ("cosim/sumo/near_egos.py", "__init__"),
    "world: advance": ("cosim/sumo/world.py", "advance"),
    "of it SUMO's step": ("libsumo.py", "step"),
    "of it taking egos over": ("cosim/sumo/world.py", "_take_over_departed"),
    "of it reading the surroundings": ("cosim/sumo/surroundings.py", "read"),
}
"""What the table names, and the function whose time it is, with all that it calls."""


def profiled(egos: int) -> pstats.Stats:
    """Drive that many egos under a profiler."""
    profile = cProfile.Profile()
    with TemporaryDirectory() as folder:
        configuration = City(VEHICLES, PERSONS, duration_s=FILLED_S + DRIVEN_S).write(Path(folder))
        share = share_of(egos, VEHICLES)
        request = RunRequest(str(configuration), "vo_mpc", SEED, actuation="hybrid", ego_share=share)
        profile.runcall(drive, request, FILLED_S)
    return pstats.Stats(profile)


def seconds(stats: pstats.Stats, function: tuple[str, str]) -> float:
    """Return the time of the functions of that name in that file, with all that they call [s]."""
    file, name = function
    rows = stats.stats.items()  # type: ignore[attr-defined]  # not in the stubs
    return sum(row[3] for (path, _, found), row in rows if found == name and path.endswith(file))


def main() -> None:
    """Print the table."""
    egos = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    stats = profiled(egos)
    whole = seconds(stats, LOOP)
    rows = [(what, f"{seconds(stats, function) / whole:.0%}") for what, function in PARTS.items()]
    print(table((f"{egos} egos among {VEHICLES} vehicles and {PERSONS} persons", "of the loop"), rows))


if __name__ == "__main__":
    main()
