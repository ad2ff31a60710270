"""Replays a contact with a competent and careful driver at the wheel of the ego.

The driver follows the path that the ego drove, and the pedestrian moves as recorded:

1. The *corridor* is what the ego's body swept, continued straight on where its recording ends.
2. The pedestrian is *observable* while both are recorded, within ``r157_view_m`` of the driver's eye,
   and no vehicle cuts the line from the eye to the pedestrian's centre. The eye is ``r157_eye_m`` behind the
   middle of the front bumper. The ego's sensors do not matter.
3. The pedestrian is a *risk* while their disc is within ``r157_wander_m`` of the corridor ahead of the body,
   or would be within ``r157_foresight_s`` at their present velocity, at a place that the body, at its present
   speed, has not passed by then. The risk begins at the first observable instant of the last spell of risk
   before the contact. A spell ends when the driver has seen no risk for ``r157_foresight_s``: a driver who
   had braked would have driven on by then. At most 30 s before the contact are considered.
4. From that instant on the driver keeps the ego's recorded speed, but no more than the limit, for
   ``r157_reaction_s``. Then the deceleration rises to ``r157_deceleration_mps2`` and stays there until the
   standstill. It rises from the ego's recorded deceleration at that time, or from 0 if the ego did not brake,
   at a rate that would take ``r157_ramp_s`` from 0.
5. The contact is *preventable* if body and disc do not touch while the replayed ego moves, until
   ``r157_after_s`` after the recorded contact. An ego at or below ``standing_speed_mps`` does not move.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray, FloatArray
from analysis.encounters.contacts import Contact
from analysis.encounters.driven_path import DrivenPath, driven_path
from analysis.encounters.line_of_sight import is_visible
from analysis.geometry import pairs_within, signed_distance, time_to_contact, to_frame
from analysis.recording.fine_grid import Grid
from analysis.recording.tracks import There, Track
from analysis.thresholds import Thresholds

_LOOK_BACK_S = 30.0
_FORESIGHT_STEP_S = 0.1
_BRAKING_STEP_S = 0.002
_SLACK_M = 1e-9


@dataclass(frozen=True, slots=True)
class Replay:
    """The result of the replay."""

    onset: float
    """Time at which the risk could first be seen; nan if it could not be seen before the contact [s]."""
    touched_at: float
    """Time at which the replayed ego touches the pedestrian while moving; nan if it does not [s]."""

    @property
    def prevented(self) -> bool:
        """Whether the careful driver does not touch the pedestrian while driving."""
        return bool(np.isnan(self.touched_at))


@dataclass(frozen=True, slots=True)
class Scene:
    """One ego and one pedestrian over consecutive samples of the fine grid, both recorded throughout."""

    ego: Track
    person: Track
    first: int
    """Fine index of the first sample."""
    time: FloatArray
    path: DrivenPath

    @property
    def own(self) -> slice:
        """Samples of the ego's track."""
        return slice(self.first - self.ego.first, self.first - self.ego.first + len(self.time))

    @property
    def other(self) -> slice:
        """Samples of the pedestrian's track."""
        return slice(self.first - self.person.first, self.first - self.person.first + len(self.time))


def replay_contact(
    ego: Track,
    person: Track,
    contact: Contact,
    limit: FloatArray,
    vehicles: There,
    grid: Grid,
    thresholds: Thresholds,
) -> Replay:
    """Return how a contact ends with the careful driver.

    Parameters
    ----------
    ego, person : Track
        The two that touched.
    contact : Contact
        The recorded contact.
    limit : FloatArray
        Speed limit at the samples of the ego's track; nan or inf where there is none [m/s].
    vehicles : There
        All vehicles that may hide the pedestrian; the ego itself is left out.
    grid : Grid
    thresholds : Thresholds
    """
    path = driven_path(ego, thresholds.r157_view_m + ego.length)
    start = max(ego.first, person.first, int(np.searchsorted(grid.time, contact.time - _LOOK_BACK_S)))
    end = min(ego.last, person.last, int(np.searchsorted(grid.time, contact.time + 1e-9, "right")) - 1)
    before = Scene(ego, person, start, grid.time[start : end + 1], path)
    seen = _observable(before, vehicles, thresholds)
    onset = _onset(before.time, seen, seen & _is_risk(before, thresholds), thresholds.r157_foresight_s)
    if onset is None:
        return Replay(float("nan"), contact.time)
    begin = before.first + onset
    until = int(np.searchsorted(grid.time, contact.time + thresholds.r157_after_s, "right")) - 1
    after = Scene(ego, person, begin, grid.time[begin : min(person.last, until) + 1], path)
    way, speed = _braking(after, limit, thresholds)
    return Replay(float(after.time[0]), _first_touch(after, way, speed, thresholds.standing_speed_mps))


def eye_of(ego: Track, samples: slice, thresholds: Thresholds) -> tuple[FloatArray, FloatArray]:
    """Return where the driver's eye was [m]."""
    ahead = 0.5 * ego.length - thresholds.r157_eye_m
    heading = ego.heading[samples]
    return ego.x[samples] + ahead * np.cos(heading), ego.y[samples] + ahead * np.sin(heading)


def _observable(scene: Scene, vehicles: There, thresholds: Thresholds) -> BoolArray:
    ego = scene.ego
    eye_x, eye_y = eye_of(ego, scene.own, thresholds)
    x, y = scene.person.x[scene.other], scene.person.y[scene.other]
    near = np.hypot(x - eye_x, y - eye_y) <= thresholds.r157_view_m
    last = scene.first + len(scene.time) - 1
    others = [one for one in vehicles(scene.first, last) if one.name != ego.name]
    return np.asarray(near & is_visible(eye_x, eye_y, x, y, scene.first, others))


def _is_risk(scene: Scene, thresholds: Thresholds) -> BoolArray:
    """Return when the disc is, or soon will be, close to the corridor that the body has yet to sweep."""
    ego, person = scene.ego, scene.person
    x, y = person.x[scene.other], person.y[scene.other]
    u, v = person.x_speed[scene.other], person.y_speed[scene.other]
    way, speed = ego.path[scene.own], ego.speed[scene.own]
    reach = 0.5 * person.width + thresholds.r157_wander_m
    risk = np.zeros(len(x), dtype=np.bool_)
    steps = round(thresholds.r157_foresight_s / _FORESIGHT_STEP_S)
    for number in range(steps + 1):
        later = number * _FORESIGHT_STEP_S
        open_ = np.flatnonzero(~risk)
        passed = way[open_] + speed[open_] * later
        hit = _meets_corridor(
            scene.path,
            x[open_] + u[open_] * later,
            y[open_] + v[open_] * later,
            passed,
            way[open_] + thresholds.r157_view_m,
            reach,
        )
        risk[open_[hit]] = True
    return risk


def _meets_corridor(
    path: DrivenPath, x: FloatArray, y: FloatArray, passed: FloatArray, end: FloatArray, reach: float
) -> BoolArray:
    """Return which points are within ``reach`` of the body at some pose between two arc lengths."""
    met = np.zeros(len(x), dtype=np.bool_)
    if len(x) == 0:
        return met
    part = path.between(float(passed.min()) - 1.0, float(end.max()))
    margin = 0.5 * float(np.hypot(path.length, path.width)) + reach
    close = (part.x >= x.min() - margin) & (part.x <= x.max() + margin)
    close &= (part.y >= y.min() - margin) & (part.y <= y.max() + margin)
    pose = np.flatnonzero(close)
    at, near = pairs_within(x, y, part.x[pose], part.y[pose], margin)
    pose = pose[near]
    along, across = to_frame(x[at] - part.x[pose], y[at] - part.y[pose], part.heading[pose])
    inside = signed_distance(along, across, 0.5 * path.length, 0.5 * path.width) <= reach
    # The pose nearest to the body's place counts as its place. Points behind the rear bumper are not ahead.
    inside &= (part.way[pose] >= passed[at] - 0.1) & (part.way[pose] <= end[at])
    inside &= along >= -0.5 * path.length
    met[at[inside]] = True
    return met


def _onset(time: FloatArray, seen: BoolArray, risk: BoolArray, quiet_s: float) -> int | None:
    """Return the sample at which the last spell of risk begins; ``None`` if there is none."""
    onset: int | None = None
    quiet_since: float | None = None
    for i in np.flatnonzero(seen).tolist():
        if risk[i]:
            onset = i if onset is None else onset
            quiet_since = None
            continue
        quiet_since = float(time[i]) if quiet_since is None else quiet_since
        if time[i] - quiet_since >= quiet_s:
            onset = None
    return onset


def _braking(scene: Scene, limit: FloatArray, thresholds: Thresholds) -> tuple[FloatArray, FloatArray]:
    """Return arc length and speed of the replayed ego at the scene's samples [m, m/s]."""
    ego, time = scene.ego, scene.time
    recorded = slice(scene.own.start, min(scene.own.stop, len(ego.path)))
    count = recorded.stop - recorded.start
    allowed = np.where(np.isnan(limit[recorded]), np.inf, limit[recorded])
    speed = np.minimum(ego.speed[recorded], allowed)
    share = np.minimum(1.0, allowed / np.maximum(ego.speed[recorded], 1e-9))
    way = ego.path[recorded.start] + np.concatenate(
        [[0.0], np.cumsum(np.diff(ego.path[recorded]) * share[:-1])]
    )
    reacts = time[0] + thresholds.r157_reaction_s
    held = time[:count]
    start_way, start_speed = float(np.interp(reacts, held, way)), float(np.interp(reacts, held, speed))
    start_way += max(0.0, reacts - float(held[-1])) * start_speed  # the ego's recording ended before
    largest = thresholds.r157_deceleration_mps2
    start_braking = -float(np.interp(reacts, held, ego.acceleration[recorded]))
    since, braked_way, braked_speed = _stop(
        start_speed, min(max(start_braking, 0.0), largest), largest, thresholds.r157_ramp_s
    )
    braking = time > reacts
    return (
        np.where(
            braking, start_way + np.interp(time - reacts, since, braked_way), np.interp(time, held, way)
        ),
        np.where(braking, np.interp(time - reacts, since, braked_speed), np.interp(time, held, speed)),
    )


def _stop(
    speed: float, braking: float, largest: float, ramp_s: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return time, distance and speed of a stop whose deceleration rises with the jerk ``largest / ramp_s``.

    Examples
    --------
    >>> _, way, _ = _stop(20 / 3.6, 0.0, 7.59, 0.6)
    >>> round(float(way[-1]), 2)
    3.59
    """
    needed = ramp_s + speed / max(largest, 1e-9) + _BRAKING_STEP_S
    time = np.arange(0.0, needed + _BRAKING_STEP_S, _BRAKING_STEP_S)
    rise = largest / ramp_s * time if ramp_s > 0.0 else np.full(len(time), largest)
    deceleration = np.minimum(braking + rise, largest)
    lost = np.concatenate([[0.0], np.cumsum(0.5 * (deceleration[1:] + deceleration[:-1]) * _BRAKING_STEP_S)])
    left = np.maximum(speed - lost, 0.0)
    way = np.concatenate([[0.0], np.cumsum(0.5 * (left[1:] + left[:-1]) * _BRAKING_STEP_S)])
    return time, way, left


def _first_touch(scene: Scene, way: FloatArray, speed: FloatArray, standing_speed: float) -> float:
    """Return when the moving replayed ego first touches the pedestrian; nan if it does not [s]."""
    ego, person = scene.ego, scene.person
    centre_x, centre_y, heading = scene.path.at(way)
    x, y = to_frame(person.x[scene.other] - centre_x, person.y[scene.other] - centre_y, heading)
    following = np.minimum(np.arange(len(x)) + 1, len(x) - 1)
    share = time_to_contact(
        x,
        y,
        x[following] - x,
        y[following] - y,
        0.5 * ego.length,
        0.5 * ego.width,
        0.5 * person.width - _SLACK_M,
    )
    share = np.where(share <= 1.0, share, np.inf)
    at_touch = speed + np.where(np.isfinite(share), share, 0.0) * (speed[following] - speed)
    hits = np.flatnonzero(np.isfinite(share) & (at_touch > standing_speed))
    if len(hits) == 0:
        return float("nan")
    i = int(hits[0])
    return float(scene.time[i] + share[i] * (scene.time[following[i]] - scene.time[i]))
