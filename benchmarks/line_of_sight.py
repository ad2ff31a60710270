"""Time of the lines of sight of 100 egos among 200 pedestrians and 400 vehicles, beside the world's own step.

A straight road of 1.5 km with three lanes a direction, full of cars; a quarter of them are egos that move by
hybrid actuation, sense by ``onboard`` with a range of 60 m, and hold their speed. The bar: less than half of
the time inside ``world.advance()``. Run with ``python benchmarks/line_of_sight.py``.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from measuring.stopwatch import Stopwatch, watching

from cosim.running.compose import compose
from cosim.running.request import RunRequest
from cosim.sensing import lines_of_sight
from cosim.sensing.senses import Senses

LENGTH, LANES = 1500.0, 3
EGOS, VEHICLES, PEDESTRIANS = 100, 400, 200
STEPS = 50
BAR = 0.5
SIGHT, LOOK, SENSE, ADVANCE = "lines of sight", "sensing models", "sense", "advance"


def write_scenario(folder: Path) -> Path:
    """Write the road and everybody on it, and return the scenario's folder."""
    draw = np.random.default_rng(1)
    per_lane = VEHICLES // (2 * LANES) + 1
    (folder / "n.nod.xml").write_text(
        f'<nodes><node id="w" x="0" y="0"/><node id="e" x="{LENGTH}" y="0"/></nodes>', "utf-8"
    )
    edge = f'numLanes="{LANES}" speed="13.89" sidewalkWidth="2.5" width="3.25"'
    (folder / "n.edg.xml").write_text(
        f'<edges><edge id="we" from="w" to="e" {edge}/><edge id="ew" from="e" to="w" {edge}/></edges>',
        "utf-8",
    )
    lines = ['<routes><vType id="car" vClass="passenger" length="4.5" width="1.8"/>']
    cars = [
        (road, lane, 20.0 + (LENGTH - 300.0) * (index + draw.uniform(0.0, 0.2)) / per_lane)
        for road in ("we", "ew")
        for lane in range(1, LANES + 1)
        for index in range(per_lane)
    ][:VEHICLES]
    for number, (road, lane, place) in enumerate(cars):
        lines.append(
            f'<vehicle id="car{number}" type="car" depart="0" departLane="{lane}" departPos="{place:.2f}" '
            f'departSpeed="3"><route edges="{road}"/></vehicle>'
        )
    for number, place in enumerate(draw.uniform(20.0, LENGTH - 200.0, PEDESTRIANS).tolist()):
        road = ("we", "ew")[number % 2]
        lines.append(
            f'<person id="p{number}" depart="0" departPos="{place:.2f}">'
            f'<walk edges="{road}" arrivalPos="{LENGTH - 5.0}"/></person>'
        )
    (folder / "d.rou.xml").write_text("\n".join([*lines, "</routes>"]), "utf-8")
    egos = [f"car{number}" for number in draw.permutation(len(cars))[:EGOS].tolist()]
    (folder / "scenario.toml").write_text(
        f"""description = "A full road"
duration_s = 60.0
warmup_s = 1.0
step_s = 0.1
[network]
nodes = "n.nod.xml"
edges = "n.edg.xml"
[demand]
routes = ["d.rou.xml"]
[egos]
vehicles = {egos!r}
[sensing]
model = "onboard"
range_m = 60.0
field_of_view_deg = 360.0
""",
        "utf-8",
    )
    return folder


def measure(place: Path) -> dict[str, Any]:
    """Return mean times per step [ms] and how much there was to see."""
    composition = compose(RunRequest(str(place), controller="constant_speed"))
    watch = Stopwatch()
    pairs: list[int] = []
    try:
        world = composition.world
        for perception in world.sense() or ():
            driver = composition.drivers[perception.ego.name]
            world.act(perception.ego.name, driver.plan(perception, driver.decide(perception)).command)
        world.advance()
        original = lines_of_sight.visible

        def counting(eye: Any, position: Any, *rest: Any) -> Any:
            pairs.append(len(position))
            return original(eye, position, *rest)

        lines_of_sight.visible = counting
        try:
            places = (
                (lines_of_sight, "visible", SIGHT),
                (Senses, "look", LOOK),
                (type(world), "sense", SENSE),
                (type(world), "advance", ADVANCE),
            )
            with watching(watch, places):
                for _ in range(STEPS):
                    perceptions = world.sense() or ()
                    for perception in perceptions:
                        driver = composition.drivers[perception.ego.name]
                        plan = driver.plan(perception, driver.decide(perception))
                        world.act(perception.ego.name, plan.command)
                    world.advance()
        finally:
            lines_of_sight.visible = original
        snapshot = world.snapshot()
    finally:
        composition.close()
    per_step = {part: 1e3 * watch.seconds[part] / STEPS for part in (SIGHT, LOOK, SENSE, ADVANCE)}
    return {
        "egos": len(snapshot.egos),
        "vehicles_near": len(snapshot.vehicles.names) + len(snapshot.egos),
        "pedestrians_near": len(snapshot.persons.names),
        "pairs_per_step": sum(pairs) / STEPS,
        "ms_per_step": per_step,
        "ratio": per_step[SIGHT] / per_step[ADVANCE],
    }


def main() -> None:
    """Measure and print."""
    with TemporaryDirectory() as folder:
        found = measure(write_scenario(Path(folder)))
    print(
        f"{found['egos']} egos, {found['pedestrians_near']} pedestrians, {found['vehicles_near']} vehicles; "
        f"{found['pairs_per_step']:.0f} pairs of ego and pedestrian within range a step"
    )
    print(
        "mean ms per step: "
        + ", ".join(f"{part} {value:.1f}" for part, value in found["ms_per_step"].items())
    )
    print(f"lines of sight over advance: {found['ratio']:.2f}; below {BAR:g} expected")


if __name__ == "__main__":
    main()
