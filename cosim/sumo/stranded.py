"""Egos that are stuck or have left their way: they take a detour, or are handed back to SUMO's driver."""

from __future__ import annotations

from typing import Any

from cosim.sumo.detours import detour, pieces_ahead
from cosim.sumo.driven_ego import DrivenEgo
from cosim.sumo.network import Network
from cosim.sumo.placement import Placement
from cosim.sumo.takeover import Takeover

MISSED = 30.0
"""An ego that has stood this long, as the first on a lane that leads off its route, takes another way [s]."""
PATIENCE = 5.0
"""An ego whose route SUMO refuses to set again for longer than this is handed back [s]."""
FARTHEST = 15.0
"""An ego further than this from the nearest place where SUMO accepts it on its way is handed back [m]."""
STOOD = 240.0
"""An ego that has stood longer is handed back: it and another vehicle might wait for each other [s]."""


class Stranded:
    """Helps stranded egos, and remembers which.

    Parameters
    ----------
    sumo : the ``libsumo`` module, or a ``traci`` connection
    network
    placement, takeover : those of the world
    """

    def __init__(self, sumo: Any, network: Network, placement: Placement, takeover: Takeover) -> None:
        self._sumo = sumo
        self._network = network
        self._placement = placement
        self._takeover = takeover
        self.given_up: list[str] = []
        """Egos that were handed back for good."""
        self.on_detours: list[str] = []
        """Egos that took a detour, once for each detour."""

    def look_where_put(self, ego: DrivenEgo) -> None:
        """Hand back an ego that SUMO cannot put near its place."""
        if not self._placement.strayed(ego.name) <= FARTHEST:
            self._give_up(ego)

    def help_on(self, ego: DrivenEgo, step: float) -> None:
        """After a step [s], hand back an ego that is stuck, or reroute one that has missed its lane."""
        ego.count_standing(step)
        if not ego.given_up and (ego.astray_for > PATIENCE or ego.stood_for > STOOD):
            self._give_up(ego)
        if ego.stood_off_the_route_for > MISSED:
            ego.stood_off_the_route_for = 0.0
            if self._is_first_on_its_lane(ego):
                self._take_detour(ego)

    def _is_first_on_its_lane(self, ego: DrivenEgo) -> bool:
        """Return whether there is no vehicle between an ego and the end of its lane.

        Its controller decides how far before the end it waits, because it needs room to turn into a gap.
        """
        vehicle, on = self._sumo.vehicle, self._sumo.lane.getLastStepVehicleIDs
        own, following = vehicle.getLanePosition(ego.name), pieces_ahead(ego.track)[1:]
        if any(on(piece.lane.name) for piece in following):
            return False
        return all(vehicle.getLanePosition(name) <= own for name in on(vehicle.getLaneID(ego.name)))

    def _take_detour(self, ego: DrivenEgo) -> None:
        """Give an ego another way to its destination, if its lane leads to one."""
        edges = detour(self._network, ego.track)
        if edges and self._placement.reroute(ego.name, edges):
            ego.track = self._takeover.track_of(
                self._sumo, ego.name, ego.executed, ego.track.route.turning, ego.track
            )
            self.on_detours.append(ego.name)

    def _give_up(self, ego: DrivenEgo) -> None:
        """Let SUMO drive an ego for good, from where it was last on its way."""
        self._placement.release(ego.name)
        ego.handed_back = ego.given_up = True
        self.given_up.append(ego.name)
