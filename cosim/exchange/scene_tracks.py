"""Trajectories of everybody in an encounter, beginning at time 0."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.encounters.recorded_case import read_case
from analysis.errors import AnalysisError
from analysis.plots.scene import Piece, Scene, choose
from controllers.interface import Body
from cosim.arrays import FloatArray
from cosim.errors import InputError
from cosim.step.plant import body_of

NEAR_M = 80.0
"""Other road users are exported if they come nearer to the ego than this [m]."""


@dataclass(frozen=True, slots=True)
class Mover:
    """One road user of an encounter."""

    name: str
    kind: str
    """``ego``, ``vehicle`` or ``pedestrian``."""
    time: FloatArray
    """Times since the beginning of the encounter [s]."""
    x: FloatArray
    """Position of a vehicle's rear axle or a pedestrian's centre [m]."""
    y: FloatArray
    heading: FloatArray
    """Heading [rad]."""
    speed: float
    """Speed at the first sample [m/s]."""
    body: Body
    """Body; a pedestrian's length and width are the disc's diameter."""


def read_movers(folder: Path, encounter: int, traffic: bool = False) -> list[Mover]:
    """Return the ego of an encounter of a recorded run and everybody who came near it.

    Parameters
    ----------
    folder
        Folder of the run.
    encounter
        The encounter's number.
    traffic
        Whether the encounter is listed in ``traffic_encounters.csv``: one of any vehicle, as in real
        trajectories.

    Raises
    ------
    InputError
        If the run cannot be read or has no such encounter.
    """
    try:
        scene = choose(read_case(folder, traffic=traffic), None, encounter)
    except AnalysisError as error:
        raise InputError(str(error)) from error
    factor, begin = scene.case.grid.factor, scene.begin_s
    (ego,) = scene.pieces()[:1]
    egos = [_vehicle(scene.ego, "ego", ego, factor, begin)]
    # Other egos are vehicles here; a vehicle that a controller takes over meanwhile is shown from then on.
    near = {
        name: piece
        for what in (("egos",) if traffic else ("vehicles", "egos"))
        for name, piece in _others(scene, ego, what)
        if name != scene.ego
    }
    vehicles = [
        _vehicle(f"vehicle {name}", "vehicle", piece, factor, begin) for name, piece in sorted(near.items())
    ]
    people = [
        _pedestrian(f"pedestrian {name}", piece, factor, begin)
        for name, piece in _others(scene, ego, "persons")
    ]
    return [one for one in (*egos, *people, *vehicles) if len(one.time) > 1]


def _others(scene: Scene, ego: Piece, what: str) -> list[tuple[str, Piece]]:
    """Return the first piece of each other road user who comes near the ego within the window."""
    found: dict[str, Piece] = {}
    for track in getattr(scene.case, what):
        first, last = max(track.first, ego.first), min(track.last, ego.last)
        if first >= last or track.name in found:
            continue
        piece = Piece(track, first, last, scene.case.grid.time[first : last + 1])
        own = slice(first - ego.first, last - ego.first + 1)
        if np.hypot(piece.x - ego.x[own], piece.y - ego.y[own]).min() < NEAR_M:
            found[track.name] = piece
    return sorted(found.items())


def _chosen(piece: Piece, factor: int) -> slice:
    """Return the slice of a piece's recorded instants."""
    return slice(-piece.first % factor, None, factor)


def _vehicle(name: str, kind: str, piece: Piece, factor: int, begin: float) -> Mover:
    chosen = _chosen(piece, factor)
    body = body_of(piece.track.length, piece.track.width)
    heading = piece.heading[chosen]
    behind = 0.5 * body.length - body.rear_overhang  # distance from the centre back to the rear axle
    x, y = piece.x[chosen] - behind * np.cos(heading), piece.y[chosen] - behind * np.sin(heading)
    speed = float(piece.track.speed[piece.part][chosen][:1].sum())
    return Mover(name, kind, piece.time[chosen] - begin, x, y, heading, speed, body)


def _pedestrian(name: str, piece: Piece, factor: int, begin: float) -> Mover:
    chosen = _chosen(piece, factor)
    diameter = piece.track.width
    x_speed, y_speed = (getattr(piece.track, one)[piece.part][chosen] for one in ("x_speed", "y_speed"))
    moving = np.hypot(x_speed, y_speed) > 1e-3
    heading = np.arctan2(y_speed, x_speed)
    # Standing pedestrians keep their last heading.
    last = np.maximum.accumulate(np.where(moving, np.arange(len(heading)), 0))
    speed = float(np.hypot(x_speed, y_speed)[:1].sum())
    body = Body(diameter, diameter, diameter, 0.5 * diameter)
    return Mover(
        name,
        "pedestrian",
        piece.time[chosen] - begin,
        piece.x[chosen],
        piece.y[chosen],
        np.unwrap(heading[last]),
        speed,
        body,
    )
