"""One run of a study, and the configuration that it shares with the runs of other seeds."""

from __future__ import annotations

import hashlib
import json
import re
import shlex
from dataclasses import dataclass

from analysis.recording.extent import EGOS
from cosim.running.request import RunRequest

Pairs = tuple[tuple[str, str], ...]
"""Names and values."""
LONGEST_LABEL = 120
"""Longest label in the name of a folder, to stay below the limit of file systems [characters]."""
_UNSAFE = re.compile(r"[^A-Za-z0-9_.+=-]+")


@dataclass(frozen=True, slots=True)
class Configuration:
    """A scenario, a controller and their parameters: everything but the seed."""

    scenario: str
    """The scenario as the study file names it; used for the run's name, so that a study can be moved."""
    place: str
    """Where the scenario is: the name of a built-in one, or an absolute path."""
    scenario_name: str
    controller: str
    scenario_settings: Pairs
    """Settings of the scenario and of the sensing model."""
    controller_settings: Pairs
    varied: Pairs
    """Settings that differ between the configurations of the study."""
    ego_route: tuple[str, ...] = ()
    ego_vehicle: str | None = None
    ego_share: float | None = None
    sensing: str | None = None
    """Sensing model; ``None`` for that of the scenario."""
    record: str = EGOS
    """Which road users a run records."""

    @property
    def settings(self) -> Pairs:
        """Parameters for ``cosim run --set``."""
        return self.scenario_settings + self.controller_settings

    @property
    def road(self) -> object:
        """The part of a configuration that does not depend on the controller."""
        egos = self.ego_route, self.ego_vehicle, self.ego_share
        return self.place, self.scenario_settings, *egos, self.sensing

    @property
    def label(self) -> str:
        """Name in tables and messages."""
        varied = ", ".join(f"{key}={value}" for key, value in self.varied)
        return f"{self.scenario_name} with {self.controller}" + (f", {varied}" if varied else "")

    def request(self, seed: int) -> RunRequest:
        """Return the request that ``cosim run`` would get."""
        return RunRequest(
            scenario=self.place,
            controller=self.controller,
            seed=seed,
            settings=dict(self.settings),
            ego_route=self.ego_route,
            ego_vehicle=self.ego_vehicle,
            ego_share=self.ego_share,
            sensing=self.sensing,
            record=self.record,
        )


@dataclass(frozen=True, slots=True)
class Job:
    """One run of a study."""

    configuration: Configuration
    seed: int

    @property
    def name(self) -> str:
        """Name of the run's folder: readable, and always the same for the same request."""
        one = self.configuration
        varied = [f"{key}={value}" for key, value in one.varied]
        label = _UNSAFE.sub("_", "-".join([one.scenario_name, one.controller, *varied]))
        asked_for = [
            *(one.scenario, one.controller, sorted(one.settings), self.seed),
            *(one.ego_route, one.ego_vehicle, one.ego_share),
            *([] if one.sensing is None else [one.sensing]),
            *([] if one.record == EGOS else [one.record]),
        ]
        digest = hashlib.sha256(json.dumps(asked_for).encode()).hexdigest()[:8]
        return f"{label[:LONGEST_LABEL]}-seed{self.seed}-{digest}"

    def request(self) -> RunRequest:
        """Return the request that ``cosim run`` would get."""
        return self.configuration.request(self.seed)

    def command(self) -> str:
        """Return the command that makes this run on its own."""
        one = self.configuration
        words = ["cosim", "run", one.place, "--controller", one.controller, "--seed", str(self.seed)]
        for key, value in one.settings:
            words += ["--set", f"{key}={value}"]
        if one.ego_route:
            words += ["--ego-route", " ".join(one.ego_route)]
        if one.ego_vehicle is not None:
            words += ["--ego-vehicle", one.ego_vehicle]
        if one.ego_share is not None:
            words += ["--ego-share", repr(one.ego_share).removesuffix(".0")]
        if one.sensing is not None:
            words += ["--sensing", one.sensing]
        if one.record != EGOS:
            words += ["--record", one.record]
        return shlex.join(words)
