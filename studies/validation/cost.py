"""``python -m studies.validation.cost``: time and memory to read and judge the packaged recording."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from sumo_scenarios import library
from sumo_scenarios.sumocfg import read_sumocfg


def main() -> None:
    """Judge the recording in a separate process on one core, and print the time and memory that it took."""
    sumocfg = library.load("braunschweig").sumocfg
    assert sumocfg is not None, "braunschweig is a packaged configuration"
    core = {min(os.sched_getaffinity(0))}
    with tempfile.TemporaryDirectory() as folder:
        network = str(read_sumocfg(sumocfg).net_file)
        words = ["analyse", "tasi", "--network", network, "--out", str(Path(folder) / "judged")]
        begun = time.monotonic()
        subprocess.run(
            [sys.executable, "-m", "cosim.cli", *words],
            check=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            preexec_fn=lambda: os.sched_setaffinity(0, core),
        )
        wall = time.monotonic() - begun
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(
        f"`cosim analyse tasi` on one core: {used.ru_utime + used.ru_stime:.0f} s of processor time "
        f"({wall:.0f} s by the clock, other work beside it), {used.ru_maxrss / 1e6:.2f} GB at most."
    )


if __name__ == "__main__":
    main()
