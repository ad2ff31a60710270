"""Findings on the options of a configuration that harm a run or that ``cosim run`` overrides."""

from __future__ import annotations

from cosim.inspection.demand import seconds
from cosim.inspection.finding import Finding, Level
from cosim.inspection.source import Source
from sumo_scenarios.preparation import SOONEST_TELEPORT_S
from sumo_scenarios.schema import LONGEST_STEP_S, SHORTEST_STEP_S
from sumo_scenarios.sumo_options import is_true

COARSE_STEP_S = 0.2
"""Steps longer than this are too coarse, as pedestrians move by more than their radius in one step [s]."""
NO_INTERACTION, JUPEDSIM = "noninteracting", "jupedsim"


def step_length(source: Source) -> Finding:
    """Report whether a run accepts the step length."""
    if not source.configured:
        return Finding(
            "step length", Level.NOTE, "a network without a configuration has none; --scaffold sets 0.1 s"
        )
    step = source.step_s
    limits = f"{SHORTEST_STEP_S:g} to {LONGEST_STEP_S:g} s"
    if not SHORTEST_STEP_S <= step <= LONGEST_STEP_S:
        wanted = '<step-length value="0.1"/>'
        return Finding("step length", Level.MISSING, f"{step:g} s; a run needs {limits}: {wanted}")
    if step > COARSE_STEP_S:
        absent = "" if "step-length" in source.options else ", SUMO's default, because none is given"
        text = f"{step:g} s{absent}; steps above {COARSE_STEP_S:g} s are too coarse to judge conflicts, "
        return Finding("step length", Level.NOTE, text + "0.1 s is recommended: cosim run --step-s 0.1")
    return Finding("step length", Level.GOOD, f"{step:g} s")


def pedestrian_model(source: Source) -> list[Finding]:
    """Report a model in which pedestrians and vehicles ignore each other, and one in which SUMO may hang."""
    model = source.options.get("pedestrian.model", "striping")
    if model.lower() == NO_INTERACTION:
        text = f"{model}: pedestrians and vehicles pass through each other; remove pedestrian.model"
        return [Finding("pedestrian model", Level.MISSING, text)]
    if model.lower() == JUPEDSIM:
        text = f"{model}: SUMO 1.28 hangs or crashes with it on some networks; if so, remove pedestrian.model"
        return [Finding("pedestrian model", Level.DANGER, text)]
    return []


def mesoscopic(source: Source) -> list[Finding]:
    """Report a mesoscopic simulation of queues, in which vehicles have no position on their lanes."""
    if not is_true(source.options, "mesosim"):
        return []
    text = "vehicles have no place in their lane, and no run is possible; remove mesosim"
    return [Finding("mesoscopic", Level.MISSING, text)]


def route_errors(source: Source) -> list[Finding]:
    """Report an option that silently drops vehicles with broken routes."""
    if not is_true(source.options, "ignore-route-errors"):
        return []
    return [Finding("route errors", Level.DANGER, "ignore-route-errors silently drops broken routes")]


def replaced(source: Source) -> list[Finding]:
    """Name the options of this configuration that ``cosim run`` overrides."""
    if not source.configured:
        return []
    options = source.options
    found: list[str] = []
    waiting = seconds(options.get("time-to-teleport", ""))
    if waiting is not None and 0.0 < waiting < SOONEST_TELEPORT_S:
        found.append(f"teleporting after {waiting:g} s of waiting, not {SOONEST_TELEPORT_S:g} s")
    waiting = seconds(options.get("time-to-teleport.highways", ""))
    if waiting is not None and waiting > 0.0:
        found.append(f"teleporting after {waiting:g} s of waiting on fast roads")
    action = options.get("collision.action", "teleport")
    if action != "warn":
        found.append(f"collision.action {action}")
    action = options.get("intermodal-collision.action", "warn")
    if action != "warn":
        found.append(f"intermodal-collision.action {action}")
    if not is_true(options, "collision.check-junctions"):
        found.append("no collision check in junctions, where the crossings are")
    if is_true(options, "step-method.ballistic"):
        found.append("the ballistic step method")
    if is_true(options, "random"):
        found.append("a random seed from the clock")
    if (seconds(options.get("lanechange.duration", "0")) or 0.0) > 0.0:
        found.append("lanechange.duration, which excludes the sublane model")
    if not found:
        return []
    text = f"SUMO alone would use: {'; '.join(found)}. cosim run overrides these"
    return [Finding("options", Level.NOTE, text)]
