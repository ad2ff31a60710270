"""The recorder, which writes while the run goes on; ``analysis/recording/columns.py`` names the columns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from types import TracebackType

from analysis.files import write_json
from analysis.recording.columns import EGOS, NEIGHBOURS, PLANS, SENSING, TIMING, TRAFFIC
from controllers.interface import Decision, Perception, Plan
from cosim.processes import uninterrupted
from cosim.recording.rows import PlannedEgo, SteppedEgo, SteppedObjects, map_entry
from cosim.recording.table_writer import TableWriter
from cosim.step.loop import ToWorld
from cosim.step.world import MapArea, Mishaps, Snapshot

PLANS_PER_SECOND = 2.0
"""Rate at which plans are kept for replay [1/s of simulated time]."""
PLANS_PER_CHUNK = 1024
"""Rows of plans in a chunk; few, as the rows are long and would take up most of a process's memory."""
TRAFFIC_PER_CHUNK = 65536
"""Rows of traffic in a chunk, several minutes of a junction: rows of one road user compress well together."""


class Recorder:
    """Writes the egos, neighbours, road users near crossings, plans, timing and sensed objects of one run.

    Use as a context manager: however the block is left, the files hold all that was recorded until then.
    Only ``timing.parquet`` contains wall-clock times.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        with ExitStack() as stack:
            self._egos = stack.enter_context(closing(TableWriter(folder, EGOS)))
            self._neighbours = stack.enter_context(closing(TableWriter(folder, NEIGHBOURS)))
            self._plans = stack.enter_context(closing(TableWriter(folder, PLANS, PLANS_PER_CHUNK)))
            self._timing = stack.enter_context(closing(TableWriter(folder, TIMING)))
            stack.pop_all()  # all are open now; if opening one had failed, the others would be closed here
        self._sensing: TableWriter | None = None
        self._traffic: TableWriter | None = None
        self._planned_now: dict[str, PlannedEgo] = {}
        self._last_kept_plan: dict[str, int] = {}
        self.first_time: float | None = None
        self.last_time: float | None = None
        self.teleports = 0
        self.mishaps = Mishaps()
        self.ego_names: set[str] = set()
        self.solves: dict[str, dict[str, int]] = {}
        """Number of optimisation programs, and of those left unsolved, by solver."""

    @property
    def records_everybody(self) -> bool:
        """Whether the traffic near crossings has been recorded."""
        return self._traffic is not None

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Record one ego's plan, made at the beginning of a step."""
        name, time = perception.ego.name, perception.ego.time
        planned = PlannedEgo(perception, decision, plan, 1000.0 * compute_s, to_world)
        self._planned_now[name] = planned
        self._timing.add(planned)
        if plan.solves is not None:
            counted = self.solves.setdefault(plan.solves.solver, {"programs": 0, "unsolved": 0})
            counted["programs"] += plan.solves.programs
            counted["unsolved"] += plan.solves.unsolved
        slot = math.floor(time * PLANS_PER_SECOND + 1e-6)
        if len(plan.times) > 0 and self._last_kept_plan.get(name) != slot:
            self._last_kept_plan[name] = slot
            self._plans.add(planned)

    def stepped(self, snapshot: Snapshot) -> None:
        """Record the world after the step."""
        if self.first_time is None:
            self.first_time = snapshot.time
        self.last_time = snapshot.time
        self.teleports = snapshot.teleports
        self.mishaps = snapshot.mishaps
        for ego in snapshot.egos:
            self.ego_names.add(ego.name)
            self._egos.add(SteppedEgo(snapshot.time, ego, self._planned_now.get(ego.name)))
        self._planned_now.clear()
        for objects in (snapshot.persons, snapshot.vehicles):
            self._neighbours.add_all(SteppedObjects(snapshot.time, objects), len(objects.names))
        if snapshot.traffic is not None:
            if self._traffic is None:
                self._traffic = TableWriter(self._folder, TRAFFIC, TRAFFIC_PER_CHUNK)
            traffic = snapshot.traffic
            for rows in (
                SteppedObjects(snapshot.time, traffic.persons),
                SteppedObjects(snapshot.time, traffic.vehicles, traffic),
            ):
                self._traffic.add_all(rows, len(rows.objects.names))
        if snapshot.sensed is not None:
            if self._sensing is None:
                self._sensing = TableWriter(self._folder, SENSING)
            for sensed in snapshot.sensed:
                self._sensing.add_all(sensed, len(sensed.names))

    def write_map(self, areas: Sequence[MapArea]) -> None:
        """Write ``map.json``: lanes, crossings and walking areas near where the egos have been."""
        write_json(self._folder / "map.json", {"areas": [map_entry(area) for area in areas]})

    def close(self) -> None:
        """Write the last rows of every file, even if one cannot be written; interrupts wait until then."""
        errors: list[OSError | MemoryError] = []
        with uninterrupted():
            for table in (
                *(self._egos, self._neighbours, self._traffic),
                *(self._plans, self._timing, self._sensing),
            ):
                try:
                    if table is not None:
                        table.close()
                except (OSError, MemoryError) as error:
                    errors.append(error)
        if errors:
            raise errors[0]
