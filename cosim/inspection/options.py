"""Findings on a configuration's options: what a run would suffer from, and what ``cosim run`` replaces."""

from __future__ import annotations

from collections.abc import Mapping

from cosim.inspection.demand import seconds
from cosim.inspection.finding import Finding, Level
from cosim.inspection.source import Source
from sumo_scenarios.schema import LONGEST_STEP_S, SHORTEST_STEP_S

COARSE_STEP_S = 0.2
"""In a longer step a pedestrian goes further than his own radius [s]."""
NO_INTERACTION = "noninteracting"
_TRUE = ("true", "1", "yes", "on", "t", "x")


def step_length(source: Source) -> Finding:
    """Say whether the step length is one that a run can have."""
    if not source.configured:
        return Finding("step length", Level.NOTE, "a network alone has none; --scaffold writes 0.1 s")
    step = source.step_s
    limits = f"{SHORTEST_STEP_S:g} to {LONGEST_STEP_S:g} s"
    if not SHORTEST_STEP_S <= step <= LONGEST_STEP_S:
        wanted = '<step-length value="0.1"/>'
        return Finding("step length", Level.MISSING, f"{step:g} s; a run needs {limits}: {wanted}")
    if step > COARSE_STEP_S:
        absent = "" if "step-length" in source.options else ", SUMO's own, because none is given"
        text = f"{step:g} s{absent}; to judge conflicts takes 0.1 s or less: cosim run --step-s 0.1"
        return Finding("step length", Level.NOTE, text)
    return Finding("step length", Level.GOOD, f"{step:g} s")


def pedestrian_model(source: Source) -> list[Finding]:
    """Say so where people and vehicles do not see each other."""
    model = source.options.get("pedestrian.model", "striping")
    if model.lower() != NO_INTERACTION:
        return []
    text = f"{model}: people and vehicles drive and walk through each other; remove pedestrian.model"
    return [Finding("pedestrian model", Level.MISSING, text)]


def route_errors(source: Source) -> list[Finding]:
    """Say so where vehicles with broken routes are left out in silence."""
    if not _is_true(source.options, "ignore-route-errors"):
        return []
    return [Finding("route errors", Level.DANGER, "ignore-route-errors leaves broken routes out in silence")]


def replaced(source: Source) -> list[Finding]:
    """Name what SUMO alone would do with this configuration and ``cosim run`` does not let it do."""
    if not source.configured:
        return []
    options = source.options
    found: list[str] = []
    waiting = seconds(options.get("time-to-teleport", "300"))
    if waiting is not None and waiting > 0.0:
        found.append(f"teleporting after {waiting:g} s of waiting")
    action = options.get("collision.action", "teleport")
    if action != "warn":
        found.append(f"collision.action {action}")
    if not _is_true(options, "collision.check-junctions"):
        found.append("no look for collisions in junctions, where crossings are")
    if _is_true(options, "step-method.ballistic"):
        found.append("the ballistic step method")
    if _is_true(options, "random"):
        found.append("a seed from the clock")
    if (seconds(options.get("lanechange.duration", "0")) or 0.0) > 0.0:
        found.append("lanechange.duration, beside which there is no sublane model")
    if not found:
        return []
    text = f"SUMO alone would have: {'; '.join(found)}. cosim run sets its own values"
    return [Finding("options", Level.NOTE, text)]


def _is_true(options: Mapping[str, str], key: str) -> bool:
    return options.get(key, "false").lower() in _TRUE
