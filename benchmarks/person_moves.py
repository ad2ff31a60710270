"""What becomes of libsumo when persons are moved about a real junction with ``person.moveToXY``.

``python benchmarks/person_moves.py`` lets 30 persons wander for 75 s about the network of Braunschweig, six
times, each in a process of its own, and prints how each ended; 139 and −11 are segmentation faults. It is why
scripted pedestrians are not persons of SUMO's: see docs/pedestrians.md.
"""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

KEEP_ROUTE = {2: "may leave the network", 6: "... and ignores permissions"}
SEEDS = (1, 2, 3)
PERSONS = 30
STEPS = 1500
WALKING = 1.4


def wander(keep_route: int, seed: int) -> None:
    """Move persons about for a while."""
    import libsumo
    import numpy as np
    import sumo

    generator = np.random.default_rng(seed)
    configuration = Path(sumo.SUMO_HOME) / "tools" / "game" / "fokr_bs_demo.sumocfg"
    libsumo.start(
        ["sumo", "-c", str(configuration), "--no-step-log", "true", "--no-warnings", "true",
         "--lateral-resolution", "0.4", "--time-to-teleport", "-1"]
    )  # fmt: skip
    for _ in range(200):
        libsumo.simulationStep()
    step = libsumo.simulation.getDeltaT()
    low, high = libsumo.simulation.getNetBoundary()
    walkable = [
        edge
        for edge in libsumo.edge.getIDList()
        if not edge.startswith(":") and "pedestrian" in libsumo.lane.getAllowed(f"{edge}_0")
    ]
    places = 0.5 * (np.array(low) + np.array(high)) + generator.normal(0.0, 60.0, (PERSONS, 2))
    headings = generator.uniform(0.0, 2.0 * math.pi, PERSONS)
    for number in range(PERSONS):
        libsumo.person.add(f"p{number}", walkable[number % len(walkable)], 1.0)
        libsumo.person.appendWaitingStage(f"p{number}", 1e6)
    for _ in range(STEPS):
        headings += generator.normal(0.0, 0.1, PERSONS)
        places += WALKING * step * np.column_stack([np.cos(headings), np.sin(headings)])
        for number, (x, y) in enumerate(places.tolist()):
            angle = (90.0 - math.degrees(headings[number])) % 360.0
            libsumo.person.moveToXY(f"p{number}", "", x, y, angle, keep_route)
        libsumo.simulationStep()
    libsumo.close()


def main() -> int:
    """Run every case and print its return code."""
    if len(sys.argv) == 3:
        wander(int(sys.argv[1]), int(sys.argv[2]))
        return 0
    for keep_route, meaning in KEEP_ROUTE.items():
        for seed in SEEDS:
            command = [sys.executable, __file__, str(keep_route), str(seed)]
            code = subprocess.run(command, capture_output=True, check=False).returncode
            print(f"keepRoute {keep_route} ({meaning}), seed {seed}: {code}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
