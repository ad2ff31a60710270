"""The data of a replay: the recorded rows around an encounter or a moment of an ego, in one script file."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial import ConvexHull

from analysis.arrays import FloatArray, IntArray
from analysis.encounters.case import Case
from analysis.errors import RecordingError
from analysis.files import write_text
from analysis.page.overlay import drawings
from analysis.page.recorded import Recording
from analysis.page.signals import crossing_signals, signal_ahead
from analysis.recording.reading import Area

BEFORE_S, AFTER_S = 2.0, 2.0
"""Times shown before and after the encounter [s]."""
LEADING_S, FOLLOWING_S = 10.0, 30.0
"""Times shown before and after a moment of an ego [s]."""
NEAR_M = 90.0
"""Road users and parts of the map further than this from the ego's way are left out [m]."""
DECIMALS = 4
"""Decimals of the numbers of a replay."""
_EGO_NUMBERS = (
    "front_x_m",
    "front_y_m",
    "heading_rad",
    "speed_mps",
    "acceleration_mps2",
    "steering_rad",
)
_EGO_TEXTS = ("rule", "manoeuvre", "because", "plan_status", "passing")
_EGO_FLAGS = ("planned", "solved", "intervention", "handed_back")
_MOVING_VEHICLE = ("x_m", "y_m", "heading_rad")
_MOVING_PERSON = ("x_m", "y_m", "x_speed_mps", "y_speed_mps")


def replay_of(recording: Recording, encounter_id: int) -> dict[str, Any]:
    """Return the data of an encounter's replay; frame i of every list is the recorded row at ``time_s[i]``.

    Raises
    ------
    RecordingError
        If the recording has no such encounter.
    """
    case = recording.case
    if encounter_id not in recording.listed:
        raise RecordingError(
            f"{case.run.folder}: the recording has {len(recording.listed)} encounters, "
            f"number {encounter_id} is asked for"
        )
    index = recording.listed[encounter_id]
    one = case.encounters[index]
    start, end = (float(case.grid.time[i]) for i in (one.first, one.last))
    mine = _between(recording, one.ego.name, start - BEFORE_S, end + AFTER_S)
    ttc, distance = _measured(case, index, _times(mine))
    return {
        "encounter_id": encounter_id,
        "ped_id": one.person.name,
        "t_start_s": _number(start),
        "t_end_s": _number(end),
        "ttc_s": ttc,
        "distance_m": distance,
        **_shown_of(recording, mine, one.ego.name, one.person.name),
    }


def replay_of_ego(recording: Recording, ego_id: str, moment_s: float) -> dict[str, Any]:
    """Return the data of a replay of an ego around a moment, as :func:`replay_of` but without a pedestrian.

    Raises
    ------
    RecordingError
        If the recording does not have the ego at that time.
    """
    mine = _between(recording, ego_id, moment_s - LEADING_S, moment_s + FOLLOWING_S)
    if mine.empty:
        raise RecordingError(f"{recording.case.run.folder}: no row of ego {ego_id} near {moment_s:.1f} s")
    nothing: list[float | None] = [None] * len(mine)
    return {
        "encounter_id": None,
        "ped_id": None,
        "ttc_s": nothing,
        "distance_m": nothing,
        **_shown_of(recording, mine, ego_id, None),
    }


def _between(recording: Recording, ego_id: str, start: float, end: float) -> pd.DataFrame:
    """Return the rows of an ego in an interval of time [s]."""
    time = recording.egos["time_s"]
    own = recording.egos["ego_id"] == ego_id
    return recording.egos[own & (time >= start - 1e-6) & (time <= end + 1e-6)].reset_index(drop=True)


def _times(rows: pd.DataFrame) -> FloatArray:
    return np.round(rows["time_s"].to_numpy(dtype=np.float64), 6)


def _shown_of(recording: Recording, mine: pd.DataFrame, ego_id: str, ped_id: str | None) -> dict[str, Any]:
    """Return the data that replays of encounters and of moments have in common."""
    case, times = recording.case, _times(mine)
    front = mine[["front_x_m", "front_y_m"]].to_numpy(dtype=np.float64)
    meta = case.run.meta
    return {
        "run": case.run.folder.name,
        "scenario_id": meta["scenario_id"],
        "controller": meta["controller"],
        "seed": meta["seed"],
        "ego_id": ego_id,
        "step_s": case.run.step_s,
        "time_s": _numbers(times),
        "ego": _ego(mine),
        "objects": _objects(recording.neighbours, times, front, ego_id, ped_id),
        "plans": _plans(recording.plans, ego_id, times),
        "map": _map(case, front),
        "crossing_signals": crossing_signals(recording.neighbours, times),
        "signal_ahead": signal_ahead(mine),
    }


def _ego(rows: pd.DataFrame) -> dict[str, Any]:
    found: dict[str, Any] = {
        "length_m": _number(float(rows["length_m"].iloc[0])),
        "width_m": _number(float(rows["width_m"].iloc[0])),
    }
    found |= {name: _numbers(rows[name]) for name in _EGO_NUMBERS}
    for name in _EGO_TEXTS:
        codes, texts = pd.factorize(rows[name])
        found[name] = {"texts": [str(text) for text in texts], "codes": codes.tolist()}
    for name in _EGO_FLAGS:
        found[name] = [None if pd.isna(value) else int(value) for value in rows[name]]
    return found


def _measured(
    case: Case, number: int, times: np.ndarray[Any, np.dtype[np.float64]]
) -> tuple[list[float | None], list[float | None]]:
    """Return TTC and distance of the encounter at recorded instants, as the analysis found them."""
    samples = case.samples
    own = samples.owner == number
    known = {
        round(float(time), 6): (ttc, distance)
        for time, ttc, distance in zip(
            samples.time[own].tolist(),
            samples.ttc[own].tolist(),
            samples.clearance[own].tolist(),
            strict=True,
        )
    }
    found = [known.get(round(float(time), 6), (math.nan, math.nan)) for time in times]
    return [_number(ttc) for ttc, _ in found], [_number(distance) for _, distance in found]


def _objects(
    rows: pd.DataFrame, times: FloatArray, front: FloatArray, ego: str, person: str | None
) -> list[dict[str, Any]]:
    """Return the objects near the ego, each with its first frame and one value for each frame from there.

    A vehicle and a person with the same id are two objects. The ego itself, which is recorded among the
    vehicles if another ego is near, is left out.
    """
    rows, frames = _shown(rows, times)
    kept = ((rows["object_kind"] != "vehicle") | (rows["object_id"] != ego)).to_numpy(dtype=np.bool_)
    rows, frames = rows[kept].reset_index(drop=True), frames[kept]
    names = {*_MOVING_VEHICLE, *_MOVING_PERSON, "length_m", "width_m"}
    numbers = {name: rows[name].to_numpy(dtype=np.float64) for name in names}
    at = front[frames]
    near = np.hypot(numbers["x_m"] - at[:, 0], numbers["y_m"] - at[:, 1]) < NEAR_M
    phases = rows["phase"].to_numpy(dtype=object)
    found = []
    each: Mapping[Any, Any] = rows.groupby(["object_id", "object_kind"], sort=True).indices
    for (name, kind), own in each.items():
        if not near[own].any():
            continue
        first, count = int(frames[own[0]]), int(frames[own[-1]] - frames[own[0]] + 1)
        place = frames[own] - first
        shown = _MOVING_VEHICLE if kind == "vehicle" else _MOVING_PERSON
        one: dict[str, Any] = {
            "id": str(name),
            "kind": str(kind),
            "type": str(rows["object_type"].iloc[own[0]]),
            "length_m": _number(float(numbers["length_m"][own[0]])),
            "width_m": _number(float(numbers["width_m"][own[0]])),
            "first": first,
        }
        for column in shown:
            whole = np.full(count, np.nan)
            whole[place] = numbers[column][own]
            one[column] = _numbers(whole)
        if kind != "vehicle":
            phase = np.full(count, None, dtype=object)
            phase[place] = phases[own]
            codes, texts = pd.factorize(phase)
            one["phase"] = {"texts": [str(text) for text in texts], "codes": codes.tolist()}
            one["met"] = int(name == person)
        found.append(one)
    return found


def _shown(rows: pd.DataFrame, times: FloatArray) -> tuple[pd.DataFrame, IntArray]:
    """Return the rows at given instants [s], and for each the index of its instant."""
    now = np.round(rows["time_s"].to_numpy(dtype=np.float64), 6)
    within = np.flatnonzero((now >= times[0]) & (now <= times[-1]))
    number = np.searchsorted(times, now[within])
    exact = times[number] == now[within]
    return rows.iloc[within[exact]], number[exact]


def _plans(rows: pd.DataFrame, ego: str, times: np.ndarray[Any, Any]) -> list[dict[str, Any]]:
    """Return the plans that the ego made during the replay, and the last one before it."""
    mine = rows[(rows["ego_id"] == ego) & (rows["time_s"] <= times[-1] + 1e-6)]
    before = mine[mine["time_s"] <= times[0] + 1e-6]
    first = before.index[-1] if len(before) else None
    found = []
    for index, row in mine.iterrows():
        if row["time_s"] < times[0] - 1e-6 and index != first:
            continue
        at = np.column_stack((row["x_m"], row["y_m"]))
        found.append(
            {
                "time_s": _number(float(row["time_s"])),
                "passing": str(row["passing"] or ""),
                "at": np.round(at, 2).ravel().tolist(),
                "horizon_s": np.round(row["horizon_s"], 3).tolist(),
                "speed_mps": np.round(row["speed_mps"], 3).tolist(),
                "overlay": drawings(str(row["overlay"] or ""), len(at)),
            }
        )
    return found


def _map(case: Case, front: np.ndarray[Any, Any]) -> list[dict[str, Any]]:
    """Return the areas near the ego's way, the ground of junctions first."""
    low, high = front.min(axis=0) - NEAR_M, front.max(axis=0) + NEAR_M
    found: list[dict[str, Any]] = []
    inner: dict[str, list[FloatArray]] = {}
    for area in case.run.areas:
        least, most = area.shape.min(axis=0), area.shape.max(axis=0)
        if (most < low).any() or (least > high).any():
            continue
        inside = area.kind == "lane" and area.name.startswith(":")  # SUMO's name of a lane in a junction
        if inside:
            inner.setdefault(area.name.rsplit("_", 2)[0], []).append(area.shape)
        found.append(
            {
                "name": area.name if area.kind == "crossing" else "",
                "kind": _kind(area, inside),
                "crossing_kind": area.crossing_kind,
                "width_m": area.width_m,
                "at": np.round(area.shape, 2).ravel().tolist(),
            }
        )
    return [*_grounds(inner.values()), *found]


def _kind(area: Area, inside: bool) -> str:
    if area.kind == "lane" and area.facts.get("on_foot"):
        return "sidewalk"
    return "inner_lane" if inside else area.kind


def _grounds(junctions: Iterable[Sequence[FloatArray]]) -> list[dict[str, Any]]:
    """Return the ground of each junction: the convex hull of its lanes."""
    found = []
    for shapes in junctions:
        points = np.unique(np.vstack(shapes), axis=0)
        if len(points) < 3 or np.linalg.matrix_rank(points - points[0], tol=0.1) < 2:
            continue  # on one line
        outline = points[ConvexHull(points).vertices]
        at = np.round(outline, 2).ravel().tolist()
        found.append({"kind": "junction", "crossing_kind": "", "width_m": 0.0, "at": at})
    return found


def _numbers(values: Any) -> list[float | None]:
    rounded = np.round(np.asarray(values, dtype=np.float64), DECIMALS) + 0.0
    if np.isfinite(rounded).all():
        return list(rounded.tolist())
    return [value if math.isfinite(value) else None for value in rounded.tolist()]


def _number(value: float) -> float | None:
    return round(value, DECIMALS) + 0.0 if math.isfinite(value) else None


def script(key: str, content: dict[str, Any]) -> str:
    """Return the text of the file that a script tag loads.

    Examples
    --------
    >>> script("a-1", {"time_s": [0.1]})
    'cosimReplayData("a-1",{"time_s":[0.1]});\\n'
    """
    text = json.dumps(content, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return f"cosimReplayData({json.dumps(key)},{text});\n"


def write_replay(key: str, content: dict[str, Any], folder: Path) -> Path:
    """Write the file of a replay and return it."""
    folder.mkdir(parents=True, exist_ok=True)
    return write_text(folder / f"{key}.js", script(key, content))
