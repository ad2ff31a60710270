"""Detours: another way to its destination for an ego that has missed its lane, as a driver would take it.

At the end of a lane that leads off its route, an ego waits for a gap in the lane beside it. SUMO's own
vehicles wait there until they are teleported. An ego is never teleported, and the vehicles behind it would
have to wait as long as it does.
"""

from __future__ import annotations

import math

from cosim.sumo.lane_chain import Piece
from cosim.sumo.network import Network
from cosim.sumo.quickest import quickest, route_to
from cosim.sumo.track import Track

SLOWEST = 0.1
"""Lowest speed assumed on a lane: a limit of 0 closes a lane [m/s]."""
NEAR, SPLIT = 30.0, 5.0
"""A vehicle this near to the end of the lanes that it follows waits for a change of lane there, even before
junctions up to the second length: in these the number of lanes changes, and no roads cross [m]."""


def on_a_lane_off_the_route(track: Track) -> bool:
    """Return whether a vehicle is on a lane that leads off its route, so that it has to change lanes.

    The lane may lead off it at the end of the next edge, if that is short and only the number of lanes
    changes in between.
    """
    path = track.path
    if path.leads_to_end:
        return False
    here, *following = pieces_ahead(track)
    splits = all(one.end - one.start < SPLIT for one in (here, *following) if one.lane.internal)
    return not following or (splits and path.chain_end - track.along < NEAR)


def pieces_ahead(track: Track) -> list[Piece]:
    """Return the lanes from the one that a vehicle is on to the last one that it can follow."""
    return track.path.between(track.along, math.inf) or [track.path.pieces[-1]]


def detour(network: Network, track: Track) -> tuple[str, ...]:
    """Return the quickest way on empty roads from where a vehicle leaves its route to the end of that route.

    Parameters
    ----------
    network
    track : where the vehicle is on its present route

    Returns
    -------
    Edges, starting with the present one, or in a junction with the one before it; empty if the lane that
    leads off the route does not lead to its end.
    """
    ahead, kind = pieces_ahead(track), track.route.vehicle_class
    last = ahead[-1]

    def reached_from(lanes: list[str]) -> list[str]:
        passable = (
            one for lane in lanes for one in network.connections.get(lane, ()) if network.passable(one, kind)
        )
        return list(dict.fromkeys(network.lanes[one.target].edge for one in passable))

    def lanes_of(edge: str) -> list[str]:
        return [network.edges[edge][index] for index in network.allowed_lanes(edge, kind)]

    def seconds(edge: str) -> float:
        lanes = (network.lanes[name] for name in lanes_of(edge))
        return min(lane.length / max(lane.speed, SLOWEST) for lane in lanes)

    end = track.route.edges[-1]
    ways = []
    for begin in reached_from([last.lane.name]):
        way = route_to(end, quickest(begin, lambda edge: reached_from(lanes_of(edge)), seconds))
        if way[0] == begin:
            ways.append(way)
    best = min(ways, key=lambda way: sum(map(seconds, way)), default=())
    return (*track.route.edges[ahead[0].step : last.step + 1], *best) if best else ()
