"""Where a run's numbers come from: ``run.json`` and the identity of a run."""

from __future__ import annotations

import hashlib
import json
import math
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from analysis.recording.extent import EGOS

PERFECT = "perfect"
"""Name of the sensing model that tells egos the truth."""
_DISTRIBUTIONS = ("libsumo", "numpy", "osqp", "qpsolvers", "scipy", "daqp", "piqp", "proxsuite", "clarabel")
"""Packages besides this tool that may change a run's numbers; those not installed are left out."""


@dataclass(frozen=True, slots=True)
class Inputs:
    """Everything that determines the numbers of a run; equal inputs give equal files."""

    scenario: str
    scenario_parameters: Mapping[str, Any]
    controller: str
    controller_parameters: Mapping[str, Any]
    seed: int
    egos: Mapping[str, Any]
    """Which vehicles the controller drives."""
    step_s: float
    warmup_s: float
    duration_s: float | None
    """Duration of the run [s]; ``None`` if it lasts until the scenario ends."""
    actuation: str
    files: Mapping[str, str]
    """SHA-256 of the files that SUMO reads, by name; the names are not part of the identities."""
    sensing: str = PERFECT
    sensing_parameters: Mapping[str, Any] = field(default_factory=dict)
    controller_files: Mapping[str, str] = field(default_factory=dict)
    """SHA-256 of the files of a controller outside the catalogue, by name; the names are not part of the
    identities."""
    record: str = EGOS
    """Which road users the run records; not part of the identities, as it changes no number of an ego."""

    def config_id(self) -> str:
        """Return the identity of all inputs except the seed: the controller's name and a hash."""
        return f"{self.controller}-{_digest(self._content(), 8)}"

    def run_id(self) -> str:
        """Return the identity of the run: a hash of the inputs and of the versions."""
        return _digest({**self._content(), "seed": self.seed, "versions": versions()}, 16)

    def _content(self) -> dict[str, Any]:
        # Default sensing is left out, so that runs keep the identities from before sensing could be chosen.
        sensing = {"sensing": self.sensing, "sensing_parameters": dict(self.sensing_parameters)}
        outside = sorted(self.controller_files.values())
        return {
            **(sensing if self.sensing != PERFECT else {}),
            **({"controller_files": outside} if outside else {}),
            "scenario": self.scenario,
            "scenario_parameters": dict(self.scenario_parameters),
            "controller": self.controller,
            "controller_parameters": dict(self.controller_parameters),
            "egos": dict(self.egos),
            "step_s": self.step_s,
            "warmup_s": self.warmup_s,
            "duration_s": self.duration_s,
            "actuation": self.actuation,
            "files": sorted(self.files.values()),
        }


def describe(inputs: Inputs, schema_version: str) -> dict[str, Any]:
    """Return the content of ``run.json`` before the first step; the rest is filled in at the end."""
    return {
        "run_id": inputs.run_id(),
        "scenario_id": inputs.scenario,
        "controller": inputs.controller,
        "seed": inputs.seed,
        "config_id": inputs.config_id(),
        "tool_version": tool_version(),
        "git_sha": git_sha(),
        "sumo_version": versions().get("libsumo"),
        "versions": versions(),
        "start_utc": datetime.now(UTC).isoformat(timespec="seconds"),
        "wall_s": None,
        "wall_control_s": None,
        "wall_world_s": None,
        "step_s": inputs.step_s,
        "warmup_s": inputs.warmup_s,
        "duration_s": None,
        "requested_duration_s": inputs.duration_s,
        "n_steps": 0,
        "n_egos": 0,
        "valid": False,
        "invalid_reason": "the run has not ended",
        "actuation": inputs.actuation,
        "sensing": inputs.sensing,
        "record": inputs.record,
        "parameters": {
            "scenario": _writable(inputs.scenario_parameters),
            "controller": _writable(inputs.controller_parameters),
            "sensing": _writable(inputs.sensing_parameters),
        },
        "egos": _writable(inputs.egos),
        "inputs": dict(inputs.files),
        "controller_files": dict(inputs.controller_files),
        "outputs_left_out": [],
        "n_teleports": 0,
        "n_routes_restored": 0,
        "n_steps_off_the_way": 0,
        "egos_given_up": [],
        "cars_not_taken": [],
        "egos_on_detours": [],
        "n_others_teleported": 0,
        "tight_bends": {},
        "solvers": {},
        "recording_schema_version": schema_version,
    }


@cache
def versions() -> dict[str, str]:
    """Return the versions of this tool and of everything that may change a run's numbers."""
    found = {"sumo-cosim": tool_version()}
    for name in _DISTRIBUTIONS:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


@cache
def tool_version() -> str:
    """Return the version of this tool; ``uninstalled`` if it runs from bare sources."""
    try:
        return metadata.version("sumo-cosim")
    except metadata.PackageNotFoundError:
        return "uninstalled"


@cache
def git_sha() -> str | None:
    """Return the commit of the running checkout, with ``-dirty`` after changes; ``None`` without one."""
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists():
        return None  # the tool is installed, perhaps inside the checkout of another project
    return commit_of(root)


def commit_of(root: Path) -> str | None:
    """Return the commit of a checkout, with ``-dirty`` after changes; ``None`` if git cannot tell."""
    # Other commands write the index of the checkout and leave a lock there if the run ends meanwhile.
    asked = ["status", "--porcelain=v2", "--branch", "--untracked-files=no"]
    command = ["git", "--no-optional-locks", "-C", str(root), *asked]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=True, timeout=10)
    except (OSError, subprocess.SubprocessError):
        return None
    commit, changed = "", ""
    for line in answer.stdout.splitlines():
        if line.startswith("# branch.oid "):
            commit = line.rpartition(" ")[2]
        elif not line.startswith("#"):
            changed = "-dirty"
    return f"{commit}{changed}" if commit.isalnum() else None


def _writable(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values with infinite ones as the texts that ``--set`` takes, as JSON has no infinity."""
    return {
        key: str(value) if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in values.items()
    }


def _digest(content: Mapping[str, Any], length: int) -> str:
    text = json.dumps(content, sort_keys=True, ensure_ascii=False, default=str)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()[:length]
