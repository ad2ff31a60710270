"""How far from its forecast a pedestrian is after 1, 2 and 3 s, for every predictor.

Egos drive by ``aeb`` through scenarios with SUMO's own and with scripted pedestrians. Once a second every
predictor is asked where those within 45 m will be, and later compared with where they are. Run with
``python benchmarks/predictors.py``; ``--write docs/prediction.md`` puts the tables into that page.
"""

from __future__ import annotations

import os

from controllers.arrays import FloatArray

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import sys
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from analysis.markdown import table, write_below
from controllers.interface import Decision, Perception, Plan
from controllers.prediction import by_name
from controllers.prediction.forecast import Predictor
from cosim.running.compose import compose
from cosim.running.request import RunRequest
from cosim.step.loop import ToWorld, run
from cosim.step.world import Snapshot

SCENARIOS = {
    "midblock_zebra": {"ego_count": "3", "duration_s": "180"},
    "midblock_unmarked": {"ego_count": "3", "duration_s": "180"},
    "jaywalk_arterial": {"ego_count": "3", "duration_s": "180"},
    "bus_stop_occlusion": {"ego_count": "3", "duration_s": "150"},
}
SEED = 1
NEAR = 45.0
HORIZONS = (1.0, 2.0, 3.0)
TIMES = np.linspace(0.0, 3.0, 31)
CROSSING, STANDING, ALONG = "walks across", "stands", "walks along"
MARK = "<!-- tables: python benchmarks/predictors.py --write docs/prediction.md -->"


@dataclass(slots=True)
class Watcher:
    """Asks all predictors, and compares when the time has come."""

    predictors: dict[str, dict[str, Predictor]] = field(default_factory=dict)
    due: dict[int, list[tuple[str, str, str, float, FloatArray, float]]] = field(
        default_factory=lambda: defaultdict(list)
    )
    errors: dict[tuple[str, str, float], list[tuple[float, bool]]] = field(
        default_factory=lambda: defaultdict(list)
    )
    """By predictor, group and horizon: distance [m], and whether it was within the forecast's reach."""

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Ask, once a second."""
        ego, people = perception.ego, perception.pedestrians
        if abs(ego.time - round(ego.time)) > 1e-6 or not len(people):
            return
        mine = self.predictors.setdefault(ego.name, {name: by_name.build(name) for name in by_name.names()})
        near = np.flatnonzero(np.hypot(people.along, people.across) < NEAR)
        for name, predictor in mine.items():
            forecast = predictor.predict(perception, TIMES)
            for horizon in HORIZONS:
                k = round(horizon / 0.1)
                places = to_world(ego.name, forecast.along[near, k], forecast.across[near, k])
                for row, place in zip(near.tolist(), places, strict=True):
                    group = _group(float(people.along_speed[row]), float(people.across_speed[row]))
                    entry = (name, group, people.names[row], horizon, place, float(forecast.reach[row, k]))
                    self.due[round(10 * (ego.time + horizon))].append(entry)

    def stepped(self, snapshot: Snapshot) -> None:
        """Compare."""
        due = self.due.pop(round(10 * snapshot.time), [])
        persons = snapshot.persons
        at = {name: row for row, name in enumerate(persons.names)}
        for name, group, person, horizon, place, reach in due:
            if person in at:
                row = at[person]
                off = float(np.hypot(persons.x[row] - place[0], persons.y[row] - place[1]))
                # The frame's centre line is a chain of straight pieces, so what comes back is not exact.
                self.errors[name, group, horizon].append((off, off <= reach + 0.05))


def _group(along_speed: float, across_speed: float) -> str:
    if np.hypot(along_speed, across_speed) < 0.2:
        return STANDING
    return CROSSING if abs(across_speed) > 0.3 else ALONG


def measure(scenario: str) -> Watcher:
    """Drive through a scenario once."""
    composition = compose(RunRequest(scenario, "aeb", SEED, SCENARIOS[scenario]))
    watcher = Watcher()
    try:
        run(composition.world, composition.drivers, watcher)
    finally:
        composition.close()
    return watcher


def errors(watcher: Watcher) -> str:
    """Return the errors as a table."""
    offsets = [f"{value} at {horizon:g} s" for horizon in HORIZONS for value in ("mean", "p95")]
    lines = []
    for group in (CROSSING, STANDING, ALONG):
        for name in by_name.names():
            found = [watcher.errors[name, group, horizon] for horizon in HORIZONS]
            if not found[-1]:
                continue
            offs = [np.array([off for off, _ in one]) for one in found]
            cells = [f"{value:.2f}" for off in offs for value in (off.mean(), np.percentile(off, 95))]
            inside = ", ".join(f"{np.mean([within for _, within in one]):.0%}" for one in found)
            lines.append([group, f"`{name}`", str(len(offs[-1])), *cells, inside])
    return table(["who", "predictor", "n", *offsets, "within reach at 1, 2, 3 s"], lines)


def main() -> None:
    """Measure, print, and write into a page where one is given."""
    blocks = []
    for scenario in SCENARIOS:
        blocks.append(f"### {scenario}\n\n{errors(measure(scenario))}\n")
        print(blocks[-1], flush=True)
    if "--write" in sys.argv:
        page = Path(sys.argv[sys.argv.index("--write") + 1])
        write_below(page, MARK, "\n".join(blocks), "# Prediction")


if __name__ == "__main__":
    main()
