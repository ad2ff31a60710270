"""How SUMO's own traffic fares with a scenario's scripted pedestrians, without egos.

``python benchmarks/scripted_flow.py jaywalk_arterial --seeds 6`` counts contacts, hard braking and speeds;
``--unseen`` does the same with drivers who do not see them, to show what being seen is worth.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import libsumo
from measuring.chosen_scenario import arguments, chosen

from cosim.conformance.stage import rectangle, separation
from cosim.pedestrians.behaviour import RADIUS
from cosim.sumo.network_file import read_network
from cosim.sumo.scripted_persons import ScriptedPersons
from sumo_scenarios.library import Scenario, prepare

HARD_BRAKING_MPS2 = 5.0
NEAR_M = 20.0


@dataclass
class Flow:
    """What was counted."""

    pedestrians: int = 0
    contacts: int = 0
    hard_s: float = 0.0
    speed_sum: float = 0.0
    vehicle_steps: int = 0
    steps: int = 0
    walking_s: float = 0.0


def count(scenario: Scenario, seed: int, unseen: bool, flow: Flow) -> None:
    """Run one seed and add to what was counted."""
    with tempfile.TemporaryDirectory() as work:
        prepared = prepare(scenario, seed, Path(work))
        begin, end = prepared.begin_s + scenario.warmup_s, prepared.begin_s + scenario.duration_s
        scripted = ScriptedPersons(scenario.pedestrians, read_network(prepared.net_file), seed, begin, end)
        libsumo.start(["sumo", *prepared.options])
        try:
            scripted.join(libsumo, scenario.step_s)
            seen: set[str] = set()
            touching: set[tuple[str, str]] = set()
            speeds: dict[str, float] = {}
            while libsumo.simulation.getTime() < end:
                started = process_time()
                scripted.walk(libsumo.simulation.getTime(), (), libsumo.vehicle.getIDList() if unseen else ())
                flow.walking_s += process_time() - started
                libsumo.simulationStep()
                before, speeds = speeds, {n: libsumo.vehicle.getSpeed(n) for n in libsumo.vehicle.getIDList()}
                flow.steps += 1
                flow.vehicle_steps += len(speeds)
                flow.speed_sum += sum(speeds.values())
                lost = [(before.get(name, 0.0) - speed) / scenario.step_s for name, speed in speeds.items()]
                flow.hard_s += scenario.step_s * sum(one > HARD_BRAKING_MPS2 for one in lost)
                people = libsumo.poi.getIDList()
                seen |= set(people)
                now = touched(people, list(speeds))
                flow.contacts += len(now - touching)
                touching = now
        finally:
            libsumo.simulationStep()
            libsumo.close()
    flow.pedestrians += len(seen)


def touched(people: tuple[str, ...], vehicles: list[str]) -> set[tuple[str, str]]:
    """Return who touches which vehicle; every scripted pedestrian is a point of interest of SUMO."""
    bodies = {name: rectangle(libsumo, name) for name in vehicles}
    found = set()
    for person in people:
        x, y = libsumo.poi.getPosition(person)
        for name, body in bodies.items():
            near = abs(body[0] - x) + abs(body[1] - y) < NEAR_M
            if near and separation(body, (x + 0.005, y, 0.0, 0.01, 0.01)) < RADIUS:
                found.add((person, name))
    return found


def main() -> int:
    """Run the seeds and print the sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    arguments(parser)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--unseen", action="store_true", help="SUMO's drivers do not see the pedestrians")
    given = parser.parse_args()
    scenario = chosen(given)
    if scenario is None:
        return 2
    flow = Flow()
    for seed in range(1, given.seeds + 1):
        count(scenario, seed, given.unseen, flow)
    print(f"pedestrians: {flow.pedestrians}; contacts with SUMO's vehicles: {flow.contacts}")
    print(f"mean speed: {flow.speed_sum / max(flow.vehicle_steps, 1):.2f} m/s")
    print(f"seconds with more than {HARD_BRAKING_MPS2:g} m/s^2 of braking: {flow.hard_s:.1f}")
    print(f"time of the pedestrians: {1000.0 * flow.walking_s / max(flow.steps, 1):.2f} ms a step")
    return 0


if __name__ == "__main__":
    sys.exit(main())
