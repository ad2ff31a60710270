"""Gaps between vehicles that pedestrians accept at crossings without signals, fitted by a logit."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd
import statsmodels.api as sm
from numpy.typing import NDArray
from scipy import stats

from analysis.arrays import FloatArray
from analysis.recording.reading import Area
from analysis.stretches import stretches
from analysis.validation.estimate import Estimate, undefined
from analysis.validation.observed import Observed

SIGNAL = "signal"
LONGEST_GAP_S = 30.0
"""A longer gap says nothing, because everybody accepts it [s]."""
LEAST_PEDESTRIANS = 10
"""With fewer pedestrians, nothing is fitted."""
LEVEL = 0.95


@dataclass(frozen=True, slots=True)
class Passage:
    """The passage of a vehicle over a crossing."""

    time_s: float
    vehicle: str


def gaps(seen: Observed) -> pd.DataFrame:
    """Return the gaps that pedestrians were offered: ``id``, ``gap_s``, ``accepted`` (0 or 1).

    A pedestrian is at the crossing from the time when they first wait for it, or step onto it. The first gap
    is the time from then to the next vehicle; later gaps are those from vehicle to vehicle. They accept the
    gap in which they step onto the crossing, and reject those before it. Crossings with signals are left out.
    """
    rows: list[tuple[str, float, float]] = []
    for crossing in seen.crossings:
        if crossing.crossing_kind == SIGNAL:
            continue
        passed = np.array([one.time_s for one in passages(seen.vehicles, crossing)])
        for name, walk in seen.people[seen.people["crossing"] == crossing.name].groupby("id"):
            for arrival, entry in _arrivals(walk):
                rows += [(str(name), gap, float(taken)) for gap, taken in _offered(passed, arrival, entry)]
    return pd.DataFrame(rows, columns=["id", "gap_s", "accepted"])


def _arrivals(walk: pd.DataFrame) -> list[tuple[float, float]]:
    """Return when a pedestrian came to a crossing and when they stepped onto it, for each walk over it."""
    time = walk["time_s"].to_numpy()
    on = (walk["phase"] == "crossing").to_numpy()
    found, before = [], 0
    for first, last in stretches(on):
        if first > 0:  # a pedestrian who came into view on the crossing was offered no gap
            found.append((float(time[before]) if before < first else float(time[first]), float(time[first])))
        before = last + 1
    return found


def _offered(passed: FloatArray, arrival: float, entry: float) -> list[tuple[float, bool]]:
    instants = [arrival, *passed[passed > arrival].tolist()]
    found = []
    for start, end in pairwise(instants):
        if start > entry:
            break
        if end - start <= LONGEST_GAP_S:
            found.append((end - start, entry < end))
        if entry < end:
            break
    return found


def passages(vehicles: pd.DataFrame, crossing: Area) -> list[Passage]:
    """Return when the fronts of vehicles passed a crossing's axis, in order of time."""
    start, end = crossing.shape[0], crossing.shape[-1]
    way = end - start
    length = float(np.hypot(*way))
    x, y = vehicles["x_m"].to_numpy() - start[0], vehicles["y_m"].to_numpy() - start[1]
    along, across = (x * way[0] + y * way[1]) / length, (way[0] * y - way[1] * x) / length
    same = vehicles["id"].to_numpy()[1:] == vehicles["id"].to_numpy()[:-1]
    over = same & (across[1:] * across[:-1] <= 0.0) & (across[1:] != across[:-1])
    over &= (np.minimum(along[1:], along[:-1]) > -1.0) & (np.maximum(along[1:], along[:-1]) < length + 1.0)
    time = vehicles["time_s"].to_numpy()
    found: dict[str, Passage] = {}
    for at in np.flatnonzero(over).tolist():
        share = across[at] / (across[at] - across[at + 1])
        name = str(vehicles["id"].iloc[at])
        found.setdefault(name, Passage(float(time[at] + share * (time[at + 1] - time[at])), name))
    return sorted(found.values(), key=lambda one: one.time_s)


def critical_gap(offered: pd.DataFrame) -> tuple[Estimate, Estimate]:
    """Return the gap that half of the pedestrians accept, and how sharply they choose.

    P(accept) = 1 / (1 + exp(-(b0 + b1 gap))). The critical gap is -b0 / b1 [s], with an interval by the delta
    method; b1 [1/s] says how sharply they choose. The larger of the model's error and the error robust to
    several gaps of one pedestrian counts, because with few pedestrians the robust one is too small.
    """
    names = ("critical_gap", "s"), ("gap_slope", "1/s")
    accepted = offered["accepted"].to_numpy(np.float64) if len(offered) else np.zeros(0)
    people = int(offered["id"].nunique()) if len(offered) else 0

    def unfitted(told: str) -> tuple[Estimate, Estimate]:
        return undefined(*names[0], people, told), undefined(*names[1], people, told)

    if people < LEAST_PEDESTRIANS or accepted.min() == accepted.max():
        return unfitted(f"{people} pedestrians chose among gaps")
    gap_s = offered["gap_s"].to_numpy(np.float64)
    if told := _separated(gap_s[accepted == 1.0], gap_s[accepted == 0.0]):
        return unfitted(told)
    model = sm.Logit(accepted, sm.add_constant(gap_s))
    groups = pd.factorize(offered["id"])[0]
    fit = model.fit(disp=0, warn_convergence=False)
    if not fit.mle_retvals["converged"]:
        return unfitted("the fit did not converge")
    robust = model.fit(disp=0, cov_type="cluster", cov_kwds={"groups": groups})
    b0, b1 = np.asarray(fit.params).tolist()
    covariances = [np.asarray(one.cov_params()) for one in (fit, robust)]
    reach = float(stats.norm.ppf(0.5 + 0.5 * LEVEL))
    slope: NDArray[np.float64] = np.array([-1.0 / b1, b0 / b1**2])
    error = max(float(np.sqrt(slope @ one @ slope)) for one in covariances)
    gap, sharp = -b0 / b1, max(float(np.sqrt(one[1, 1])) for one in covariances)
    method = "logit"
    return (
        Estimate(*names[0], gap, gap - reach * error, gap + reach * error, people, method),
        Estimate(*names[1], b1, b1 - reach * sharp, b1 + reach * sharp, people, method),
    )


def _separated(accepted: FloatArray, rejected: FloatArray) -> str:
    """Return how the gaps are separated; empty if they overlap. Separated gaps have no best logit fit."""
    if accepted.min() >= rejected.max():
        return "no accepted gap is shorter than a rejected one"
    return "no accepted gap is longer than a rejected one" if accepted.max() <= rejected.min() else ""
