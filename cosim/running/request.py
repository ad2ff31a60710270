"""A user's request for one run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from analysis.recording.extent import EGOS, EVERYBODY
from controllers.outside.given import Given
from cosim.errors import InputError

ACTUATIONS = ("hybrid", "move")


@dataclass(frozen=True, slots=True)
class RunRequest:
    """One scenario, one controller, one seed."""

    scenario: str
    """Name of a scenario, a scenario's folder, a case ``suite:NAME/CASE``, or a SUMO configuration."""
    controller: str | Given = "vo_mpc"
    """Name or address of a controller, or a controller that a program hands over."""
    seed: int = 1
    settings: Mapping[str, str] = field(default_factory=dict)
    """Scenario or controller parameters as texts, by name."""
    duration_s: float | None = None
    """Time to record after the warm-up [s]; ``None`` for that of the scenario. The scenario's parameter of
    the same name counts from the beginning of the simulation."""
    step_s: float | None = None
    """Length of a simulation step [s]; ``None`` for that of the scenario."""
    actuation: str | None = None
    """``hybrid`` or ``move``; ``None`` for that of the scenario."""
    ego_route: tuple[str, ...] = ()
    """Edges of the route of an additional vehicle, which is the ego."""
    ego_vehicle: str | None = None
    """Vehicle of the demand to take over as the ego."""
    ego_share: float | None = None
    """Share of the passenger cars to take over as egos; 0 for no egos at all."""
    sensing: str | None = None
    """Sensing model through which egos perceive pedestrians; ``None`` for that of the scenario."""
    record: str = EGOS
    """``egos`` or ``everybody``; a run that records everybody needs no ego."""
    gui: bool = False
    out: Path | None = None

    def __post_init__(self) -> None:
        chosen = [
            flag
            for flag, given in (
                ("--ego-route", bool(self.ego_route)),
                ("--ego-vehicle", self.ego_vehicle is not None),
                ("--ego-share", self.ego_share is not None),
            )
            if given
        ]
        if len(chosen) > 1:
            raise InputError(f"{' and '.join(chosen)} exclude each other; give only one")
        if self.record not in (EGOS, EVERYBODY):
            raise InputError(f"--record: expected {EGOS} or {EVERYBODY}, got {self.record!r}")
        if self.ego_share == 0.0 and self.record != EVERYBODY:
            raise InputError("--ego-share 0: a run without egos has to record everybody: --record everybody")
        if self.ego_share is not None and not 0.0 <= self.ego_share <= 1.0:
            raise InputError(f"--ego-share: expected a share above 0 and at most 1, got {self.ego_share:g}")
        if self.ego_vehicle is not None and not self.ego_vehicle.strip():
            raise InputError("--ego-vehicle: expected the id of a vehicle of the demand, got none")
        if self.duration_s is not None and not 0.0 < self.duration_s < float("inf"):
            raise InputError(f"--duration-s: expected a number of seconds above 0, got {self.duration_s:g}")
        if self.actuation is not None and self.actuation not in ACTUATIONS:
            raise InputError(f"--actuation: expected {' or '.join(ACTUATIONS)}, got {self.actuation!r}")
        if not 0 <= self.seed < 2**31:
            raise InputError(f"--seed: expected a whole number from 0 to {2**31 - 1}, got {self.seed}")


def parse_settings(texts: Iterable[str], example: str = "pedestrians_per_hour=600") -> dict[str, str]:
    """Return the names and values of ``key=value`` texts; if a name is repeated, its last value counts.

    Parameters
    ----------
    texts : texts as given after ``--set``
    example : example for the error message

    Raises
    ------
    InputError
        If a text has no name or no ``=``.

    Examples
    --------
    >>> parse_settings(["pedestrians_per_hour=600", "steps=20"])
    {'pedestrians_per_hour': '600', 'steps': '20'}
    """
    settings: dict[str, str] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or not key.strip():
            raise InputError(f"--set {text!r}: expected key=value, for instance {example}")
        settings[key.strip().replace("-", "_")] = value.strip()
    return settings
