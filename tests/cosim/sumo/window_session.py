"""A run in sumo-gui, looked at from inside; started on a screen of its own by test_window.py.

Writes what it saw into the file that is named as argument, and a picture of the window beside it.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import traci

from controllers.interface import Decision, Perception, Plan
from cosim.running import compose
from cosim.running.request import RunRequest
from cosim.step import loop
from cosim.step.broadcast import Broadcast
from cosim.step.loop import ToWorld
from cosim.step.world import Snapshot
from cosim.sumo.window import VIEW, line_name

SHOT_AT_S = 40.0


class Onlooker:
    """Compares what sumo-gui has with what was planned, at every step."""

    def __init__(self, picture: Path) -> None:
        self.picture = picture
        self.plans = 0
        self.wrong: list[str] = []
        self.colours: set[tuple[int, ...]] = set()
        self.lines_without_ego: set[str] = set()
        self.egos = 0

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        name = perception.ego.name
        wanted = to_world(name, plan.along, plan.across)
        shape = traci.polygon.getShape(line_name(name))
        self.plans += 1
        off = max(
            abs(a - b)
            for one, other in zip(shape, wanted, strict=True)
            for a, b in zip(one, other, strict=True)
        )
        if off > 0.02:
            self.wrong.append(f"{perception.ego.time}: {off} m")

    def stepped(self, snapshot: Snapshot) -> None:
        names = {ego.name for ego in snapshot.egos}
        self.egos = max(self.egos, len(names))
        self.colours |= {tuple(traci.vehicle.getColor(name)) for name in names}
        self.lines_without_ego |= {
            line for line in traci.polygon.getIDList() if line not in {line_name(name) for name in names}
        }
        if abs(snapshot.time - SHOT_AT_S) < 1e-6:
            traci.gui.screenshot(VIEW, str(self.picture))


def main(target: Path) -> None:
    """Run, look, and write what was seen."""
    settings = {"warmup_s": "10", "ego_count": "1"}
    request = RunRequest("midblock_zebra", "vo_mpc", duration_s=50.0, settings=settings, gui=True)
    composition = compose.compose(request)
    onlooker = Onlooker(target.with_suffix(".png"))
    try:
        assert composition.window is not None
        # The window first: the onlooker sees what it has done in the same step.
        loop.run(composition.world, composition.drivers, Broadcast(composition.window, onlooker))
    finally:
        composition.close()
    seen = {
        "plans": onlooker.plans,
        "wrong": onlooker.wrong,
        "colours": sorted(onlooker.colours),
        "lines_without_ego": sorted(onlooker.lines_without_ego),
        "egos": onlooker.egos,
    }
    target.write_text(json.dumps(seen))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
