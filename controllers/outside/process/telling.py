"""Turns a perception into a message of the step protocol, and a command into a decision and a plan."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving import lane_keeping
from controllers.interface import (
    HAND_BACK,
    Command,
    Decision,
    EgoState,
    Manoeuvre,
    Neighbour,
    Pedestrians,
    Perception,
    Plan,
    RoadAhead,
    Vehicles,
)
from controllers.outside.process import messages

_GAPS = tuple(messages.Gaps.model_fields)


def told(perception: Perception, step: int) -> dict[str, Any]:
    """Return the message for a perception, which holds plain values only."""
    return {
        "type": "perception",
        "step": step,
        "ego": _ego(perception.ego),
        "pedestrians": _pedestrians(perception.pedestrians),
        "vehicles": _vehicles(perception.vehicles),
        "gaps": {name: _neighbour(getattr(perception.gaps, name)) for name in _GAPS},
        "road": _road(perception.road),
    }


def decision_of(command: messages.Command, perception: Perception) -> Decision:
    """Return the decision of a program.

    Raises
    ------
    ValueError
        If its target lane does not exist.
    """
    road = perception.road
    target = road.reference if command.target_lane is None else command.target_lane
    if road.lane(target) is None:
        raise ValueError(
            f"target_lane {target}: there are {', '.join(str(one.number) for one in road.lanes)}"
        )
    return Decision(Manoeuvre(command.manoeuvre), target, because=command.because)


def plan_of(command: messages.Command, perception: Perception, decision: Decision) -> Plan:
    """Return the plan of a program.

    Raises
    ------
    ValueError
        If its lists do not have the same length, or its times do not ascend from 0.
    """
    if decision.manoeuvre is Manoeuvre.HAND_BACK:
        return Plan(HAND_BACK, command.solved, command.status)
    if command.times_s is None and command.steering_rad is None:
        times = lane_keeping.instants(perception.ego)
    else:
        times = np.array([0.0] if command.times_s is None else command.times_s)
    if not len(times) or times[0] != 0.0 or not (np.diff(times) > 0.0).all():
        raise ValueError("times_s: expected ascending times that begin with 0")
    acceleration = _spread(command.acceleration_mps2, times, "acceleration_mps2")
    if command.steering_rad is None:
        lane = perception.road.lane(decision.target_lane)
        instants = lane_keeping.instants(perception.ego)
        acceleration = acceleration[np.searchsorted(times, instants + 1e-9, side="right") - 1]
        times = instants
        steering = lane_keeping.steering(perception, lane.offset if lane else 0.0, acceleration)
    else:
        steering = _spread(command.steering_rad, times, "steering_rad")
    return Plan(Command(times, acceleration, steering), command.solved, command.status)


def _spread(values: float | list[float], times: FloatArray, name: str) -> FloatArray:
    if not isinstance(values, list):
        return np.full(len(times), values)
    if len(values) != len(times):
        raise ValueError(f"{name}: {len(values)} values for {len(times)} times")
    return np.array(values)


def _ego(ego: EgoState) -> dict[str, Any]:
    body, drive = ego.body, ego.drive
    return {
        "name": ego.name,
        "time_s": ego.time,
        "x_m": ego.x,
        "y_m": ego.y,
        "heading_rad": ego.heading,
        "across_m": ego.across,
        "heading_error_rad": ego.heading_error,
        "speed_mps": ego.speed,
        "acceleration_mps2": ego.acceleration,
        "steering_rad": ego.steering,
        "plan_interval_s": ego.plan_interval,
        "length_m": body.length,
        "width_m": body.width,
        "wheelbase_m": body.wheelbase,
        "rear_overhang_m": body.rear_overhang,
        "drive_lag_s": drive.drive_lag,
        "steering_lag_s": drive.steering_lag,
        "max_acceleration_mps2": drive.max_acceleration,
        "max_deceleration_mps2": drive.max_deceleration,
        "max_steering_rad": drive.max_steering,
        "max_steering_rate_radps": drive.max_steering_rate,
    }


def _pedestrians(people: Pedestrians) -> list[dict[str, Any]]:
    columns = {
        "along_m": people.along,
        "across_m": people.across,
        "along_speed_mps": people.along_speed,
        "across_speed_mps": people.across_speed,
        "radius_m": people.radius,
        "on_crossing": people.on_crossing,
        "waiting": people.waiting,
        "uncertainty_m": people.uncertainty,
    }
    rows = _rows(people.names, columns)
    for row, crossing in zip(rows, people.crossing.tolist(), strict=True):
        row["crossing"] = crossing if crossing >= 0 else None
    return rows


def _vehicles(cars: Vehicles) -> list[dict[str, Any]]:
    columns = {
        "along_m": cars.along,
        "across_m": cars.across,
        "along_speed_mps": cars.along_speed,
        "across_speed_mps": cars.across_speed,
        "acceleration_mps2": cars.acceleration,
        "heading_error_rad": cars.heading_error,
        "length_m": cars.length,
        "width_m": cars.width,
    }
    return _rows(cars.names, columns)


def _rows(names: tuple[str, ...], columns: dict[str, Any]) -> list[dict[str, Any]]:
    keys = ("name", *columns)
    values = [column.tolist() for column in columns.values()]
    return [dict(zip(keys, row, strict=True)) for row in zip(names, *values, strict=True)]


def _neighbour(one: Neighbour | None) -> dict[str, Any] | None:
    if one is None:
        return None
    return {
        "name": one.name,
        "gap_m": one.gap,
        "speed_mps": one.speed,
        "acceleration_mps2": one.acceleration,
        "length_m": one.length,
    }


def _road(road: RoadAhead) -> dict[str, Any]:
    return {
        "lanes": [
            {
                "number": one.number,
                "offset_m": one.offset,
                "width_m": one.width,
                "follows_route_for_m": _within_view(one.follows_route_for),
            }
            for one in road.lanes
        ],
        "reference": road.reference,
        "right_edge_m": road.right_edge,
        "left_edge_m": road.left_edge,
        "curvature_step_m": road.curvature_step,
        "curvature_1pm": road.curvature.tolist(),
        "limit_along_m": road.limit_along.tolist(),
        "limit_mps": road.limit.tolist(),
        "crossings": [
            {
                "name": one.name,
                "kind": one.kind.value,
                "entry_m": one.entry,
                "exit_m": one.exit,
                "stop_line_m": one.stop_line,
                "right_m": one.right,
                "left_m": one.left,
                "pedestrians_have_green": one.pedestrians_have_green,
            }
            for one in road.crossings
        ],
        "signals": [
            {"name": one.name, "stop_line_m": one.stop_line, "state": one.state.value} for one in road.signals
        ],
        "stop_signs": [{"name": one.name, "stop_line_m": one.stop_line} for one in road.stop_signs],
        "foes": [
            {
                "name": one.name,
                "entry_m": one.entry,
                "exit_m": one.exit,
                "stop_line_m": one.stop_line,
                "foe_entry_m": one.foe_entry,
                "foe_exit_m": one.foe_exit,
                "foe_speed_mps": one.foe_speed,
                "must_yield": one.must_yield,
                "waiting_place_m": one.waiting_place,
            }
            for one in road.foes
        ],
        "route_end_m": _within_view(road.route_end),
    }


def _within_view(distance: float) -> float | None:
    return distance if math.isfinite(distance) else None
