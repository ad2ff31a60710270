"""A record that forwards the events of the step to several records."""

from __future__ import annotations

from controllers.interface import Decision, Perception, Plan
from cosim.step.loop import Record, ToWorld
from cosim.step.world import Snapshot


class Broadcast:
    """Forwards each event to several records, in the order given."""

    def __init__(self, *records: Record) -> None:
        self._records = records

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Forward one ego's plan."""
        for record in self._records:
            record.planned(perception, decision, plan, compute_s, to_world)

    def stepped(self, snapshot: Snapshot) -> None:
        """Forward the world after the step."""
        for record in self._records:
            record.stepped(snapshot)
