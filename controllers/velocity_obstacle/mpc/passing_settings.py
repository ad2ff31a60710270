"""Parameters of the speed plans that say how pedestrians are passed."""

from __future__ import annotations

from dataclasses import dataclass, field

from controllers.conflicts.expected_behaviour import PedestrianAssumptions
from controllers.conflicts.hidden_pedestrians import HiddenPedestrian


@dataclass(frozen=True, slots=True)
class PassingSettings:
    """How pedestrians are passed."""

    margin_along: float
    margin_across: float
    hysteresis: float
    lock: float
    max_classes: int
    passes: int
    reconsider: float
    """Interval at which other classes are tried while the present one is reachable [s]."""
    standstill_gap: float
    bend_acceleration: float
    assume: PedestrianAssumptions
    hidden: HiddenPedestrian = field(default_factory=lambda: HiddenPedestrian(0.0))
    uncertainty_gain: float = 0.0
    """Growth of a margin per metre of standard deviation of a position."""
