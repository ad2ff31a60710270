"""Export of an encounter as OpenSCENARIO XML 1.2, on the run's network as OpenDRIVE."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from analysis.files import completing
from cosim.errors import InputError
from cosim.exchange.scene_tracks import Mover, read_movers
from cosim.recording import folders
from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.opendrive import write_opendrive

MINOR_VERSION = 2
CREATED = datetime(2000, 1, 1)
"""Fixed creation date, so that the same encounter always gives the same bytes."""
HEIGHTS = {"pedestrian": 1.7}
HEIGHT = 1.5
"""Height of vehicles, which SUMO's recordings do not contain [m]."""
WHEEL_M = 0.65
TRACK_SHARE = 0.85
"""Distance between the wheels of an axle as a share of the body's width."""


def write_openscenario(
    folder: Path, encounter: int, network: Path | None, out: Path, traffic: bool = False
) -> list[Path]:
    """Write an encounter and its road, and return the files.

    Parameters
    ----------
    folder
        Folder of the run.
    encounter
        The encounter's ``encounter_id``.
    network
        The run's network, a ``.net.xml`` file; if ``None``, no road is written.
    out
        New or empty folder.
    traffic
        Whether the encounter is listed in ``traffic_encounters.csv``.

    Raises
    ------
    InputError
        If the input is bad, the folder cannot be written to, or scenariogeneration is missing.
    """
    xosc = _library()
    folders.check(out)
    movers = read_movers(folder, encounter, traffic)
    road, scenario = out / f"encounter-{encounter}.xodr", out / f"encounter-{encounter}.xosc"
    try:
        out.mkdir(parents=True, exist_ok=True)
        if network is not None:
            with completing(road) as part:
                _convert(network, part)
        title = f"{folder.resolve().name}, encounter {encounter}"
        content = _scenario(xosc, title, movers, None if network is None else road.name)
        with completing(scenario) as part:
            content.write_xml(str(part))
    except OSError as error:
        raise InputError(f"cannot write to {out}: {error.strerror or error}") from error
    return [scenario] if network is None else [scenario, road]


def _library() -> Any:
    try:
        from scenariogeneration import xosc
    except ImportError as error:
        raise InputError("OpenSCENARIO needs scenariogeneration: pip install scenariogeneration") from error
    return xosc


def _convert(network: Path, target: Path) -> None:
    try:
        write_opendrive(network, target)
    except ScenarioError as error:
        raise InputError(str(error)) from error


def _scenario(xosc: Any, name: str, movers: Sequence[Mover], road: str | None) -> Any:
    entities, init = xosc.Entities(), xosc.Init()
    act = xosc.Act("act", _from(xosc, "start of the act", 0.0))
    for one in movers:
        entities.add_scenario_object(one.name, _entity(xosc, one))
        place = xosc.WorldPosition(*_rounded(one.x[0], one.y[0]), h=_angle(one.heading[0]))
        init.add_init_action(one.name, xosc.TeleportAction(place))
        init.add_init_action(
            one.name,
            xosc.AbsoluteSpeedAction(
                round(one.speed, 4),
                xosc.TransitionDynamics(xosc.DynamicsShapes.step, xosc.DynamicsDimension.time, 0),
            ),
        )
        act.add_maneuver_group(_group(xosc, one))
    end = max(float(one.time[-1]) for one in movers)
    board = xosc.StoryBoard(init, _from(xosc, "end", end, "stop"))
    board.add_act(act)
    return xosc.Scenario(
        name,
        "sumo-cosim",
        xosc.ParameterDeclarations(),
        entities,
        board,
        xosc.RoadNetwork(road),
        xosc.Catalog(),
        osc_minor_version=MINOR_VERSION,
        creation_date=CREATED,
    )


def _group(xosc: Any, one: Mover) -> Any:
    trajectory = xosc.Trajectory(f"way of {one.name}", closed=False)
    places = [
        xosc.WorldPosition(*_rounded(x, y), h=_angle(heading))
        for x, y, heading in zip(one.x, one.y, one.heading, strict=True)
    ]
    trajectory.add_shape(xosc.Polyline([round(float(time), 3) for time in one.time], places))
    follow = xosc.FollowTrajectoryAction(
        trajectory, xosc.FollowingMode.position, xosc.ReferenceContext.absolute, 1, 0
    )
    event = xosc.Event(f"drive {one.name}", xosc.Priority.override)
    event.add_trigger(_from(xosc, f"start of {one.name}", float(one.time[0])))
    event.add_action(f"follow {one.name}", follow)
    maneuver = xosc.Maneuver(f"maneuver of {one.name}")
    maneuver.add_event(event)
    group = xosc.ManeuverGroup(f"group of {one.name}")
    group.add_actor(one.name)
    group.add_maneuver(maneuver)
    return group


def _entity(xosc: Any, one: Mover) -> Any:
    body, height = one.body, HEIGHTS.get(one.kind, HEIGHT)
    middle = 0.5 * body.length - body.rear_overhang
    box = xosc.BoundingBox(*_rounded(body.width, body.length, height), *_rounded(middle, 0.0, 0.5 * height))
    if one.kind == "pedestrian":
        return xosc.Pedestrian(one.name, 75, xosc.PedestrianCategory.pedestrian, box, "pedestrian")
    track = round(TRACK_SHARE * body.width, 3)
    front = xosc.Axle(0.6, WHEEL_M, track, round(body.wheelbase, 3), 0.5 * WHEEL_M)
    rear = xosc.Axle(0.0, WHEEL_M, track, 0.0, 0.5 * WHEEL_M)
    return xosc.Vehicle(one.name, xosc.VehicleCategory.car, box, front, rear, 70, 10, 10)


def _from(xosc: Any, name: str, time: float, point: str = "start") -> Any:
    condition = xosc.SimulationTimeCondition(round(time, 3), xosc.Rule.greaterOrEqual)
    return xosc.ValueTrigger(name, 0, xosc.ConditionEdge.none, condition, triggeringpoint=point)


def _rounded(*values: float) -> list[float]:
    return [round(float(value), 4) for value in values]


def _angle(value: float) -> float:
    return round(float(value), 5)
