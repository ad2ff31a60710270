"""Tries a controller on a road without SUMO, to find settings that do not work before a run begins."""

from __future__ import annotations

from collections.abc import Mapping

from controllers.interface import Controller
from cosim.errors import InputError
from cosim.step.toy_road import ToyCrossing, ToyPedestrian, ToyRoad, ToyVehicle, walk
from cosim.step.toy_world import ToyWorld


def rehearse(name: str, controller: Controller, given: Mapping[str, object]) -> None:
    """Let a controller plan twice, behind a slower car and towards a pedestrian on a zebra crossing.

    The values of parameters are checked when a controller is built. A missing solver or an impossible
    tolerance shows only when it is used.

    Parameters
    ----------
    name, controller
        The controller to try; do not use it afterwards, because controllers have memory.
    given
        The parameters that are not defaults, for the message.

    Raises
    ------
    InputError
        If the controller fails, or its command cannot be carried out.
    """
    world = ToyWorld(
        road=ToyRoad(lanes=2, crossings=(ToyCrossing(40.0),)),
        pedestrians=(ToyPedestrian("somebody", walk(42.0, -1.0, 0.0, 1.2)),),
        vehicles=(ToyVehicle("leader", walk(30.0, 0.0, 8.0, 0.0)),),
    )
    try:
        for _ in range(2):
            for perception in world.sense() or ():
                plan = controller.plan(perception, controller.decide(perception))
                world.act(perception.ego.name, plan.command)
            world.advance()
    except (Exception, SystemExit) as error:  # a plug-in may raise anything; re-raised for the user
        text = " ".join(str(error).split())
        if isinstance(error, ValueError):
            raise InputError(f"controller '{name}': {text}") from error
        values = ", ".join(f"{key}={value}" for key, value in given.items())
        raise InputError(
            f"controller '{name}' with {values or 'its defaults'} cannot plan on a plain road: "
            f"{type(error).__name__}: {text}"
        ) from error
