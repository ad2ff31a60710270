"""Notes that a user needs beside the numbers of a run, one line each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from analysis.files import read_json
from analysis.sealing import has_hashes

BESIDE_THE_LANE = 2.0
"""Egos farther than this from their lane's centre line are reported [m]."""
COARSE_STEP_S = 0.2
"""Steps longer than this are too coarse, as pedestrians move by more than their radius in one step [s]."""
JUDGED_STEP_S = 0.1
"""Recommended step length [s]."""


def run_notes(description: Mapping[str, Any]) -> list[str]:
    """Return the notes on a run, given the content of its ``run.json``."""
    step_s = float(description["step_s"])
    advised = f"{JUDGED_STEP_S:g}"
    coarse = (
        f"the step was {step_s:g} s; steps above {COARSE_STEP_S:g} s are too coarse to judge conflicts, "
        f"{advised} s is recommended: use --step-s {advised}"
    )
    return ([coarse] if step_s > COARSE_STEP_S else []) + outputs_notes([description]) + _mishaps(description)


def outputs_notes(descriptions: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return one line on the outputs that runs did not let SUMO write; empty if there are none."""
    names = list(dict.fromkeys(name for one in descriptions for name in one.get("outputs_left_out", ())))
    text = f"{len(names)} outputs of SUMO that the inputs ask for were not written"
    return [_with_first(text, names)] if names else []


def unverified(folders: Iterable[Path]) -> list[str]:
    """Return the note on finished runs whose files have no hashes, and so cannot be verified."""
    listed = list(folders)
    without = [folder for folder in listed if not has_hashes(folder) and _ended(folder)]
    if not without:
        return []
    text = f"{len(without)} of {len(listed)} runs were made without hashes of their files; not verified"
    return [_with_first(text, [str(folder) for folder in without])]


def _ended(folder: Path) -> bool:
    """Return whether a run was not cut off; unreadable files are reported elsewhere."""
    try:
        return read_json(folder / "run.json").get("wall_s") is not None
    except (OSError, ValueError):
        return False


def _mishaps(description: Mapping[str, Any]) -> list[str]:
    """Return what the coupling could not do, one line each."""
    found = []
    given_up, not_taken = description["egos_given_up"], description["cars_not_taken"]
    if given_up:
        why = "left their path, or stood for too long, and were handed back to SUMO's driver"
        text = f"{len(given_up)} egos {why}"
        found.append(_with_first(text, given_up))
    detours = description["egos_on_detours"]
    if detours:
        text = f"{len(detours)} times an ego had missed its lane and took another way to its destination"
        found.append(_with_first(text, detours))
    elsewhere = description["n_others_teleported"]
    if elsewhere:
        found.append(f"SUMO's own vehicles that were teleported after standing for too long: {elsewhere}")
    beside = {lane: off for lane, off in description["tight_bends"].items() if off > BESIDE_THE_LANE}
    if beside:
        furthest = max(beside.values())
        text = f"egos drive up to {furthest:.1f} m beside lanes with too tight bends"
        found.append(_with_first(text, list(beside)))
    if not_taken:
        text = f"{len(not_taken)} cars of --ego-share stay with SUMO (route cannot be driven)"
        found.append(_with_first(text, not_taken))
    return found


def _with_first(text: str, names: Sequence[str]) -> str:
    return f"{text}: {names[0]}{', …' if len(names) > 1 else ''}"
