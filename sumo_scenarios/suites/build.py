"""Builds ordinary scenarios from the cases of test protocols.

The road is straight unless the ego turns, and the ego drives at the speed limit, which is the test speed. The
pedestrian is so far away that the ego has driven steadily for a while before it has to react.
"""

from __future__ import annotations

import math
from typing import Any

from sumo_scenarios.model import HYBRID_LATERAL_RESOLUTION_M, Scenario, egos_of, with_pedestrians
from sumo_scenarios.schema import ScenarioTable, defaults
from sumo_scenarios.suites.case import Case, find
from sumo_scenarios.suites.tables import FOLDER

ROAD = FOLDER / "road"
WARMUP_S = 1.0
APPROACH_S = 9.0
"""Time that the ego takes from where it appears to the pedestrian's place [s]."""
APPEARS_M = 10.0
"""Position by which the ego is on the road at the latest [m]."""
AFTERWARDS_S = 12.0
"""Time for the ego to stop and for the pedestrian to leave its path [s]."""
CLOSING_S = 6.0
"""Pedestrians who walk along the ego's path set off when it would catch up with them in this time [s]."""
EGO_WIDTH_M = 1.8
FRONT_M = 3.55
"""Distance from an ego's rear axle to its front bumper [m]."""
RADIUS_M = 0.25
"""Radius of pedestrians [m]."""
PARKED_BEFORE_M = 1.0
"""Distance from the front of the nearer parked car to the line that the pedestrian walks on [m]."""
NEARER_LENGTH_M = 4.5
PARKED_APART_M = 1.0
FOREVER_S = 1e4
IDEAL_BUT_FOR_SIGHT = {
    "model": "onboard",
    "range_m": 150.0,
    "field_of_view_deg": 180.0,
    "position_noise_m": 0.0,
    "velocity_noise_mps": 0.0,
    "miss_probability": 0.0,
    "confirm_hits": 1,
    "confirm_looks": 1,
}
"""Ideal sensing, except that parked cars hide what is behind them."""


def load_case(reference: str) -> Scenario:
    """Return the scenario of ``suite:NAME/CASE``.

    Raises
    ------
    ScenarioError
        If there is no such suite or case.
    """
    return scenario_of(find(reference))


def scenario_of(case: Case) -> Scenario:
    """Return the scenario of a case."""
    table = ScenarioTable.model_validate(_table(case))
    parameters = defaults(table)
    return with_pedestrians(
        Scenario(
            name=case.scenario_name,
            folder=ROAD,
            sumocfg=None,
            description=case.description,
            begin_s=0.0,
            duration_s=table.duration_s,
            warmup_s=table.warmup_s,
            step_s=table.step_s or 0.1,
            actuation=table.actuation,
            lateral_resolution_m=HYBRID_LATERAL_RESOLUTION_M,
            vehicles_per_hour=None,
            pedestrians_per_hour=None,
            parameters=parameters,
            egos=egos_of(table, parameters),
            table=table,
        )
    )


def place_of(case: Case) -> float:
    """Return where along the road the ego meets the pedestrian, or where they set off along it [m]."""
    return APPEARS_M + APPROACH_S * case.ego_speed_kmh / 3.6


def walking_time(case: Case, way: float) -> float:
    """Return how long the pedestrian takes from standstill over a distance ``way`` [s].

    Over the acceleration distance s, the mean speed is half of v: t = (way + s) / v beyond s, and
    t = 2 √(way · s) / v within it.
    """
    speed, ramp = case.group.pedestrian_speed_kmh / 3.6, case.group.acceleration_distance_m
    return 2.0 * math.sqrt(way * ramp) / speed if way < ramp else (way + ramp) / speed


def _table(case: Case) -> dict[str, Any]:
    group, place = case.group, place_of(case)
    speed = case.ego_speed_kmh / 3.6
    road = f"{group.turns}_{group.turn_radius_m:g}" if group.turns else "open"
    if group.obstructed:
        road = "parking"
    closing = CLOSING_S if group.motion == "along" else 0.0
    table: dict[str, Any] = {
        "description": case.description,
        "duration_s": round(WARMUP_S + APPROACH_S + closing + AFTERWARDS_S, 3),
        "warmup_s": WARMUP_S,
        "step_s": 0.1,
        "network": {
            "nodes": f"{road}.nod.xml" if group.turns else "nodes.nod.xml",
            "edges": f"{road}.edg.xml",
            "netconvert": ["--default.speed", f"{speed:.6f}", "--precision", "6"],
        },
        "demand": {"routes": ["parked_cars.rou.xml" if group.obstructed else "nobody.rou.xml"]},
        "egos": {"count": 1, "depart_lane": "1" if group.obstructed else "0", "routes": [{"edges": "road"}]},
        "pedestrians": [_pedestrian(case, place)],
    }
    if group.obstructed:
        nearer = place - PARKED_BEFORE_M
        further = nearer - NEARER_LENGTH_M - PARKED_APART_M
        table["sensing"] = dict(IDEAL_BUT_FOR_SIGHT)
        table["parameters"] = {
            "nearer_front_m": {
                "default": round(nearer, 6),
                "description": "Front of the parked car that the pedestrian passes",
            },
            "further_front_m": {"default": round(further, 6), "description": "Front of the one behind it"},
        }
    return table


def _pedestrian(case: Case, place: float) -> dict[str, Any]:
    """Return the case's row of ``[[pedestrians]]``."""
    group = case.group
    side = -1.0 if group.comes_from == "right" else 1.0
    row: dict[str, Any] = {
        "name": "pedestrian",
        "kind": "line",
        "lane": "road_1" if group.obstructed else "road_0",
        "speed_mps": group.pedestrian_speed_kmh / 3.6 or 1.0,
        "acceleration_distance_m": group.acceleration_distance_m,
    }
    if group.motion in ("along", "standing"):
        across = side * _beside(case)
        row |= {"from_m": [place, across], "to_m": [place + 300.0, across]}
        if group.motion == "standing":
            return row | {"stop_after_m": 0.0, "stay_s": FOREVER_S, "start": {"time_s": 0.0}}
        return row | {"start": {"ego_distance_m": _head_start(case)}}
    assert group.start_distance_m is not None
    begin = group.start_distance_m
    row |= {"from_m": [place, side * begin], "to_m": [place, -side * begin]}
    if group.motion == "turning":
        return row | {"start": {"ego_distance_m": _turning_distance(case)}}
    if group.motion == "crossing":
        return row | {"start": {"overlap": group.overlap, "ego_speed_mps": case.ego_speed_kmh / 3.6}}
    # As for a pedestrian who walks on and meets the near side of the ego, but this one stops.
    near = walking_time(case, begin - 0.5 * EGO_WIDTH_M)
    distance = RADIUS_M + near * case.ego_speed_kmh / 3.6
    stop = {"stop_after_m": begin - _beside(case), "stay_s": FOREVER_S}
    return row | stop | {"start": {"ego_distance_m": distance}}


def _turning_distance(case: Case) -> float:
    """Return the distance along the lane at which the pedestrian sets off before a turning ego [m].

    This is the distance for an overlap, except that the front bumper's position is measured along the lane.
    While the rear axle is on the turning circle of radius R, the bumper is R · atan(f / R) ahead of it along
    the lane, and not f as after the turn.
    """
    assert case.group.turn_radius_m is not None
    assert case.group.start_distance_m is not None
    assert case.group.overlap is not None
    radius = case.group.turn_radius_m
    seen = radius * math.atan(FRONT_M / radius)
    walks = walking_time(case, case.group.start_distance_m - (0.5 - case.group.overlap) * EGO_WIDTH_M)
    return RADIUS_M + walks * case.ego_speed_kmh / 3.6 + FRONT_M - seen


def _beside(case: Case) -> float:
    """Return the lateral distance from the middle of the ego's path to the pedestrian [m]."""
    if case.group.beside_m is not None:
        return 0.5 * EGO_WIDTH_M + case.group.beside_m + RADIUS_M
    assert case.group.overlap is not None
    return (0.5 - case.group.overlap) * EGO_WIDTH_M


def _head_start(case: Case) -> float:
    """Return the ego's distance when a pedestrian on its path sets off, to be reached CLOSING_S later [m].

    With the acceleration distance s, the pedestrian has walked v · t − s by then, and the front bumper is r
    behind them.
    """
    ego, walker = case.ego_speed_kmh / 3.6, case.group.pedestrian_speed_kmh / 3.6
    return (ego - walker) * CLOSING_S + case.group.acceleration_distance_m + RADIUS_M
