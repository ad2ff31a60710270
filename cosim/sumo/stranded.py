"""Egos that get nowhere or have left their way: they take a detour, or are handed back to SUMO's driver."""

from __future__ import annotations

from typing import Any

from cosim.sumo.detours import detour
from cosim.sumo.driven_ego import DrivenEgo
from cosim.sumo.network import Network
from cosim.sumo.placement import Placement
from cosim.sumo.takeover import Takeover

MISSED = 30.0
"""An ego that has stood for so long, first on a lane that leads off its route, takes another way [s]."""
PATIENCE = 5.0
"""An ego whose route SUMO refuses to set anew for longer than this is handed back [s]."""
FARTHEST = 15.0
"""An ego further than this from where SUMO can have it on its way is handed back [m]."""
STOOD = 240.0
"""An ego that has stood for longer is handed back: it might wait for who waits for it [s]."""


class Stranded:
    """Helps egos on, and remembers which.

    Parameters
    ----------
    sumo : the ``libsumo`` module, or a ``traci`` connection
    network
    placement, takeover : of the world
    """

    def __init__(self, sumo: Any, network: Network, placement: Placement, takeover: Takeover) -> None:
        self._sumo = sumo
        self._network = network
        self._placement = placement
        self._takeover = takeover
        self.given_up: list[str] = []
        """Who was handed back for good."""
        self.on_detours: list[str] = []
        """Who took a detour, once for each time."""

    def look_where_put(self, ego: DrivenEgo) -> None:
        """Hand back an ego that SUMO cannot have near its place."""
        if not self._placement.strayed(ego.name) <= FARTHEST:
            self._give_up(ego)

    def help_on(self, ego: DrivenEgo, step: float) -> None:
        """After a step [s], hand back an ego that gets nowhere; one that missed its lane takes a detour."""
        ego.count_standing(step)
        if not ego.given_up and (ego.astray_for > PATIENCE or ego.stood_for > STOOD):
            self._give_up(ego)
        if ego.stood_off_the_route_for > MISSED:
            ego.stood_off_the_route_for = 0.0
            if self._is_first_on_its_lane(ego):
                self._take_detour(ego)

    def _is_first_on_its_lane(self, ego: DrivenEgo) -> bool:
        """Return whether an ego waits for no vehicle between it and the end of its lane.

        How far before the end it waits is its controller's to say: for a gap it needs room to turn into.
        """
        vehicle = self._sumo.vehicle
        own = vehicle.getLanePosition(ego.name)
        others = self._sumo.lane.getLastStepVehicleIDs(vehicle.getLaneID(ego.name))
        return all(vehicle.getLanePosition(name) <= own for name in others)

    def _take_detour(self, ego: DrivenEgo) -> None:
        """Give an ego another way to its destination, if its lane leads to one."""
        edges = detour(self._network, ego.track)
        if edges and self._placement.reroute(ego.name, edges):
            ego.track = self._takeover.track_of(
                self._sumo, ego.name, ego.executed, ego.track.route.turning, ego.track.number
            )
            self.on_detours.append(ego.name)

    def _give_up(self, ego: DrivenEgo) -> None:
        """Let SUMO drive an ego from where it was last on its way."""
        self._placement.release(ego.name)
        ego.handed_back = ego.given_up = True
        self.given_up.append(ego.name)
