"""Keeps SUMO's route of a driven vehicle the ego's own: a move to a place may change it, and so may others.

By its place SUMO finds a moved vehicle on the first of its route's passages that fits, and lets its route go
on from there. docs/coupling.md says what follows from it.
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
    """Edges of it before the present one."""
    ahead: tuple[str, ...]
    """Edges still to drive, as they were when SUMO's route was last seen to be the ego's own."""
    name: str
    """SUMO's name of that route; a changed route has another one."""
    whole: str = ""
    """SUMO's name of a route from which SUMO does not take the driven edges."""
    restored: int = 0
    """How often the rest of it had to be set again."""
    astray: bool = False
    """After the last step SUMO had another route than the ego's own, or the ego on a foreign lane."""
    left: bool = False
    """It was another route."""


class RouteKeeper:
    """Compares and mends the routes of any number of vehicles.

    Parameters
    ----------
    connection : the ``libsumo`` module, or a ``traci`` connection
    lanes : of its network
    """

    def __init__(self, connection: Any, lanes: Lanes) -> None:
        self._connection = connection
        self._lanes = lanes
        self._refusal: type[Exception] = getattr(connection, "TraCIException", Exception)
        self._shortened = 0
        self.restored_of_all = 0
        """How often a route had to be set again, of all vehicles so far."""

    def of(self, vehicle: str) -> OwnRoute:
        """Return SUMO's route of a vehicle as its own."""
        return OwnRoute(*self._read(vehicle), self._connection.vehicle.getRouteID(vehicle))

    def changed(self, vehicle: str, own: OwnRoute) -> bool:
        """Return whether SUMO has another route, by its name."""
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
        """Take SUMO's route as the ego's own, without driven edges where it comes by one of them again."""
        self._take(vehicle, own, *self._read(vehicle))

    def keep(self, vehicle: str, own: OwnRoute, lane: str, believed: str, moved: bool) -> None:
        """Compare SUMO's route and lane with the ego's own, and set the rest of the route again.

        Where SUMO takes no route that leads on from the lane on which it has the ego, the next step puts it
        back on its way first.

        Parameters
        ----------
        vehicle, own : what is compared
        lane : on which SUMO has it
        believed : on which it was put, or was last
        moved : it was put there in the last step
        """
        driven, rest = self._read(vehicle)
        ours = own.ahead
        if rest[1:] == ours and lane.startswith(":") and self._lanes.on_way(_edge_of(lane), rest[:2]):
            ours = rest  # between two lanes, SUMO has it still in the junction that it has left
        kept = bool(rest) and ours[-len(rest) :] == rest
        if kept and moved:  # and not on the way back along the same road, or at the end of a round trip
            gone = len(ours) - len(rest)
            kept = self._lanes.on_way(_edge_of(believed), ours[max(gone - 1, 0) : gone + 2])
        own.left = not kept
        own.astray = not kept or (bool(lane) and not self._lanes.on_way(_edge_of(lane), ours))
        if kept:
            if not own.astray:
                self._take(vehicle, own, driven, rest)
            return
        # SUMO takes no route that the present edge or the way through the junction does not lead along.
        fits = bool(rest) and rest[0] in own.ahead and (lane == believed or not lane.startswith(":"))
        if lane and fits:  # else again after the next step
            try:
                self._connection.vehicle.setRoute(vehicle, own.ahead[own.ahead.index(rest[0]) :])
            except self._refusal:
                return  # it stays astray; who drives it decides for how long
            own.name = self._connection.vehicle.getRouteID(vehicle)
            own.restored += 1
            self.restored_of_all += 1

    def _read(self, vehicle: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Return the edges of SUMO's route that are driven, and those from the present one on."""
        of = self._connection.vehicle
        edges, present = tuple(of.getRoute(vehicle)), max(of.getRouteIndex(vehicle), 0)
        return edges[:present], edges[present:]

    def _take(self, vehicle: str, own: OwnRoute, driven: tuple[str, ...], ahead: tuple[str, ...]) -> None:
        own.driven, own.ahead = driven, ahead
        own.name = self._connection.vehicle.getRouteID(vehicle)
        if own.name != own.whole and self._lanes.meets_again(driven, ahead):
            self._shorten(vehicle, own)

    def _shorten(self, vehicle: str, own: OwnRoute) -> None:
        """Take the driven edges off SUMO's route; to `setRoute` SUMO adds them again."""
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
