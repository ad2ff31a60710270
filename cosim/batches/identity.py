"""Compares the inputs of a finished run with those that it would have now."""

from __future__ import annotations

import hashlib
import importlib.util
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from analysis.recording.columns import SCHEMA_VERSION
from cosim.recording import provenance
from cosim.recording.provenance import Inputs

PACKAGES = ("analysis", "controllers", "cosim", "sumo_scenarios")
WITHOUT_INFLUENCE = (
    *("analysis/criteria", "analysis/protocols", "analysis/search", "analysis/statistics", "analysis/study"),
    *(
        "cosim/api",
        "cosim/batches",
        "cosim/checks",
        "cosim/cli",
        "cosim/conformance",
        "cosim/exchange",
        "cosim/gym",
        "cosim/presentation",
        "cosim/search",
    ),
    "cosim/suites",
)
"""Beginnings of paths in our own source on which no number of a run depends."""
STRATEGIES = "controllers/strategies/"
"""Folder of the controllers, which do not import each other."""
CONTROLLER_PLUGINS = "cosim.controllers"

_COMPARED = (
    *("scenario_id", "controller", "seed", "sensing"),
    *("step_s", "warmup_s", "requested_duration_s", "actuation"),
)
_NESTED = ("parameters", "egos", "inputs", "controller_files", "versions")


@dataclass(frozen=True, slots=True)
class Identity:
    """The inputs that determine the numbers of a run."""

    run_id: str
    source: str
    """Hash of the code that makes and analyses the run."""
    description: Mapping[str, Any]
    """The compared part of ``run.json``."""


def identity_of(inputs: Inputs, source: str) -> Identity:
    """Return the identity of a run that has yet to be made."""
    description = provenance.describe(inputs, SCHEMA_VERSION)
    kept = {key: description[key] for key in (*_COMPARED, *_NESTED)}
    # Converted to JSON and back, as the file is: tuples become lists.
    return Identity(inputs.run_id(), source, json.loads(json.dumps(kept)))


def differences(wanted: Identity, description: Mapping[str, Any], source: str) -> list[str]:
    """Return how the inputs of a finished run differ from the present ones; empty if they do not.

    Parameters
    ----------
    wanted : Identity
    description : Mapping
        Content of the finished run's ``run.json``.
    source : str
        Hash of the code that made it.
    """
    found = []
    if description.get("run_id") != wanted.run_id:
        before = dict(_flat(description))
        now = dict(_flat(wanted.description))
        for key in sorted(before.keys() | now.keys()):
            if before.get(key) != now.get(key):
                found.append(_told(key, before.get(key), now.get(key)))
        found = found or [f"run_id: {description.get('run_id')} then, {wanted.run_id} now"]
    if source != wanted.source:
        found.append("the source code of the tool or of a controller has changed")
    return found


def _flat(description: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key in _COMPARED:
        yield key, description.get(key)
    for part in _NESTED:
        yield from _leaves(part, description.get(part) or {})


def _leaves(prefix: str, values: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _leaves(f"{prefix}.{key}", value)
        else:
            yield f"{prefix}.{key}", value


def _told(key: str, before: Any, now: Any) -> str:
    part, _, name = key.partition(".")
    if part in ("inputs", "controller_files"):
        if before is None or now is None:
            return f"input file {name} is {'new' if before is None else 'gone'}"
        return f"input file {name} has another content"
    what = {"versions": "version of ", "egos": "egos: ", "parameters": "parameter "}.get(part, "")
    return f"{what}{name or key}: {before} then, {now} now"


@cache
def source_digest(controller: str) -> str:
    """Return a hash of the code that a run's numbers depend on, which also tells apart edited checkouts.

    Parameters
    ----------
    controller : str
        If the controller is a plug-in, its module is included.
    """
    digest = hashlib.sha256()
    for path in (*_own_files(controller), *_plugin_files(controller)):
        content = path.read_bytes()
        digest.update(f"{path.name} {len(content)} ".encode())
        digest.update(content)
    return digest.hexdigest()[:16]


def _own_files(controller: str) -> Iterator[Path]:
    root = Path(__file__).resolve().parents[2]
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            name = path.relative_to(root).as_posix()
            if name.startswith(STRATEGIES) and path.stem != controller:
                continue
            if not name.startswith(WITHOUT_INFLUENCE):
                yield path


def _plugin_files(controller: str) -> Iterator[Path]:
    for point in entry_points(group=CONTROLLER_PLUGINS, name=controller):
        found = importlib.util.find_spec(point.module)
        if found is not None and found.origin is not None:
            yield Path(found.origin)
