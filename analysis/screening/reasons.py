"""Says in plain words what sets a crossing apart from the others of its network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from analysis.arrays import FloatArray

MORE, LONGER = 1.5, 1.3
"""A volume, or a length, is mentioned if it is more than this many times the median."""
FASTER_MPS = 10.0 / 3.6
"""A speed is mentioned if it is higher than the median by more than this [m/s]."""
RATHER_SHARE = 0.15
"""A share is mentioned if it is worse than the median by more than this."""


def reasons(values: Mapping[str, FloatArray], compared: Sequence[int]) -> list[str]:
    """Return for each crossing what is unusual about it; empty if nothing is.

    Parameters
    ----------
    values
        ``speed`` [m/s], ``vehicles``, ``pedestrians`` [1/h], ``yields``, ``late``, ``red``, ``hidden``
        (shares) and ``length`` [m], shape (n,); nan for what is undefined.
    compared
        Indices of the crossings whose median counts as usual.
    """
    usual = {name: _median(some[list(compared)]) for name, some in values.items()}
    return ["; ".join(_of(number, values, usual)) for number in range(len(values["length"]))]


def _median(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else float("nan")


def _of(number: int, values: Mapping[str, FloatArray], usual: Mapping[str, float]) -> list[str]:
    own = {name: float(some[number]) for name, some in values.items()}
    found = []
    if own["speed"] > usual["speed"] + FASTER_MPS:
        kmh, median = 3.6 * own["speed"], 3.6 * usual["speed"]
        found.append(f"fast vehicles (85th percentile {kmh:.0f} km/h, median of all {median:.0f})")
    for name, unit in (("vehicles", "vehicles"), ("pedestrians", "pedestrians")):
        if own[name] > MORE * usual[name]:
            found.append(f"many {unit} ({own[name]:.0f} an hour, median of all {usual[name]:.0f})")
    if own["yields"] < usual["yields"] - RATHER_SHARE:
        found.append(f"drivers rarely yield ({own['yields']:.0%}, median of all {usual['yields']:.0%})")
    if own["late"] > usual["late"] + RATHER_SHARE:
        told = f"{own['late']:.0%}, median of all {usual['late']:.0%}"
        found.append(f"pedestrians enter close before vehicles ({told})")
    if own["red"] > usual["red"] + RATHER_SHARE:
        found.append(f"pedestrians walk on red ({own['red']:.0%})")
    if own["hidden"] > usual["hidden"] + RATHER_SHARE:
        told = f"{own['hidden']:.0%} of conflicts, median of all {usual['hidden']:.0%}"
        found.append(f"sight obstructed by vehicles ({told})")
    if own["length"] > LONGER * usual["length"]:
        found.append(f"long crossing ({own['length']:.0f} m, median of all {usual['length']:.0f})")
    return found
