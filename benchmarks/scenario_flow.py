"""How a scenario flows by itself, without egos: speeds, pedestrians on crossings, SUMO's collisions.

``python benchmarks/scenario_flow.py midblock_zebra --seed 3 --duration-s 600 --set pedestrians_per_hour=600``
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from pathlib import Path

import libsumo
from measuring.chosen_scenario import arguments, chosen

from sumo_scenarios.library import prepare

HARD_BRAKING_MPS2 = 5.0


def main() -> int:
    """Run one scenario and print what flowed."""
    parser = argparse.ArgumentParser(description=__doc__)
    arguments(parser)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--duration-s", type=float, default=600.0)
    given = parser.parse_args()
    scenario = chosen(given)
    if scenario is None:
        return 2
    speed_sum, vehicle_steps, hard, pedestrian_steps, steps = 0.0, 0, 0, 0, 0
    entered: Counter[str] = Counter()
    collisions: Counter[tuple[str, str]] = Counter()
    before: set[tuple[str, str]] = set()
    with tempfile.TemporaryDirectory() as work:
        prepared = prepare(scenario, given.seed, Path(work))
        libsumo.start(["sumo", *prepared.options])
        try:
            while libsumo.simulation.getTime() < prepared.begin_s + given.duration_s:
                libsumo.simulationStep()
                steps += 1
                vehicles = libsumo.vehicle.getIDList()
                vehicle_steps += len(vehicles)
                speed_sum += sum(map(libsumo.vehicle.getSpeed, vehicles))
                hard += sum(libsumo.vehicle.getAcceleration(name) < -HARD_BRAKING_MPS2 for name in vehicles)
                collisions.update((c.collider, c.victim) for c in libsumo.simulation.getCollisions())
                persons = libsumo.person.getIDList()
                pedestrian_steps += len(persons)
                places = {(name, libsumo.person.getRoadID(name)) for name in persons}
                now = {(name, edge) for name, edge in places if edge.startswith(":") and "_c" in edge}
                entered.update(edge for _, edge in now - before)
                before = now
            waiting = len(libsumo.simulation.getPendingVehicles())
        finally:
            libsumo.close()
    minutes = given.duration_s / 60.0
    print(f"vehicles: {vehicle_steps / steps:.1f} on average, {waiting} waiting to come in at the end")
    print(f"mean speed: {speed_sum / max(vehicle_steps, 1):.2f} m/s")
    print(f"vehicle steps with more than {HARD_BRAKING_MPS2:g} m/s^2 of braking: {hard}")
    print(f"pedestrians: {pedestrian_steps / steps:.1f} on average; entered a crossing, per minute:")
    for edge, count in sorted(entered.items()):
        print(f"  {edge}: {count / minutes:.1f}")
    print(f"colliding pairs that SUMO reports: {len(collisions)}")
    for collider, victim in sorted(collisions):
        print(f"  {collider} into {victim}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
