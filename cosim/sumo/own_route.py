"""Keeps SUMO's route of a driven vehicle equal to the ego's own; moves and other programs may change it.

SUMO locates a moved vehicle by its position, on the first edge of its route that fits, and continues its
route from there. docs/coupling.md explains the consequences.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cosim.sumo.lanes import Lanes


@dataclass(slots=True)
class OwnRoute:
    """The route of one driven vehicle."""

    driven: tuple[str, ...]
    """Edges of the route before the present one."""
    ahead: tuple[str, ...]
    """Edges still to drive, as they were when SUMO's route was last seen to be the ego's own."""
    name: str
    """SUMO's name of that route; a changed route has another one."""
    whole: str = ""
    """SUMO's name of a route whose driven edges SUMO refused to remove."""
    restored: int = 0
    """How often the rest of the route had to be set again."""
    astray: bool = False
    """Whether SUMO had another route than the ego's own after the last step, or had it on a foreign lane."""
    left: bool = False
    """Whether SUMO had another route."""


class RouteKeeper:
    """Compares and restores the routes of any number of vehicles.

    Parameters
    ----------
    connection : the ``libsumo`` module, or a ``traci`` connection
    lanes : lanes of its network
    """

    def __init__(self, connection: Any, lanes: Lanes) -> None:
        self._connection = connection
        self._lanes = lanes
        self._refusal: type[Exception] = getattr(connection, "TraCIException", Exception)
        self._shortened = 0
        self.restored_of_all = 0
        """How often a route of any vehicle had to be set again so far."""

    def of(self, vehicle: str) -> OwnRoute:
        """Return SUMO's present route of a vehicle as the vehicle's own."""
        return OwnRoute(*self._read(vehicle), self._connection.vehicle.getRouteID(vehicle))

    def changed(self, vehicle: str, own: OwnRoute) -> bool:
        """Return whether SUMO's route has another name than the vehicle's own."""
        return bool(self._connection.vehicle.getRouteID(vehicle) != own.name)

    def reroute(self, vehicle: str, edges: Sequence[str], own: OwnRoute | None) -> bool:
        """Give a vehicle another route from the edge it is on, and return whether SUMO takes it."""
        try:
            self._connection.vehicle.setRoute(vehicle, edges)
        except self._refusal:
            return False
        if own is not None:
            self.take(vehicle, own)
        return True

    def take(self, vehicle: str, own: OwnRoute) -> None:
        """Take SUMO's route as the ego's own, and remove driven edges if it passes a junction again."""
        self._take(vehicle, own, *self._read(vehicle))

    def keep(self, vehicle: str, own: OwnRoute, lane: str, believed: str, moved: bool) -> None:
        """Compare SUMO's route and lane with the ego's own, and set the rest of the route again.

        If SUMO accepts no such route from the lane on which it has the ego, the next step first puts the ego
        back on its way.

        Parameters
        ----------
        vehicle, own : the vehicle and the ego's own route
        lane : lane on which SUMO has the vehicle
        believed : lane on which it was put, or was last
        moved : whether it was put there in the last step
        """
        driven, rest = self._read(vehicle)
        ours = own.ahead
        if rest[1:] == ours and lane.startswith(":") and self._lanes.on_way(_edge_of(lane), rest[:2]):
            ours = rest  # between two lanes, SUMO still has it in the junction that it has left
        kept = bool(rest) and ours[-len(rest) :] == rest
        if kept and moved:  # rule out the way back along the same road, and the end of a round trip
            gone = len(ours) - len(rest)
            kept = self._lanes.on_way(_edge_of(believed), ours[max(gone - 1, 0) : gone + 2])
        own.left = not kept
        own.astray = not kept or (bool(lane) and not self._lanes.on_way(_edge_of(lane), ours))
        if kept:
            if not own.astray:
                self._take(vehicle, own, driven, rest)
            return
        # SUMO refuses a route unless the present edge or the way through the junction leads along it.
        fits = bool(rest) and rest[0] in own.ahead and (lane == believed or not lane.startswith(":"))
        if lane and fits:  # otherwise try again after the next step
            try:
                self._connection.vehicle.setRoute(vehicle, own.ahead[own.ahead.index(rest[0]) :])
            except self._refusal:
                return  # it stays astray; the caller decides for how long
            own.name = self._connection.vehicle.getRouteID(vehicle)
            own.restored += 1
            self.restored_of_all += 1

    def _read(self, vehicle: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Return the edges of SUMO's route that have been driven, and those from the present one on."""
        of = self._connection.vehicle
        edges, present = tuple(of.getRoute(vehicle)), max(of.getRouteIndex(vehicle), 0)
        return edges[:present], edges[present:]

    def _take(self, vehicle: str, own: OwnRoute, driven: tuple[str, ...], ahead: tuple[str, ...]) -> None:
        own.driven, own.ahead = driven, ahead
        own.name = self._connection.vehicle.getRouteID(vehicle)
        if own.name != own.whole and self._lanes.meets_again(driven, ahead):
            self._shorten(vehicle, own)

    def _shorten(self, vehicle: str, own: OwnRoute) -> None:
        """Remove the driven edges from SUMO's route; with `setRoute`, SUMO would add them again."""
        self._shortened += 1
        shorter = f"{vehicle}!ahead{self._shortened}"
        try:
            self._connection.route.add(shorter, own.ahead)
            self._connection.vehicle.setRouteID(vehicle, shorter)
        except self._refusal:
            own.whole = own.name
        else:
            own.driven, own.name = (), shorter


def _edge_of(lane: str) -> str:
    return lane.rpartition("_")[0]
