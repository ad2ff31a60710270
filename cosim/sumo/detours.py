"""Detours: another way to its destination for an ego that has missed its lane, as a driver would take it.

At the end of a lane that leads off its route, an ego waits for a gap in the lane beside it. SUMO's own
vehicles wait there until they are teleported. An ego is never teleported, and the vehicles behind it would
have to wait as long as it does.
"""

from __future__ import annotations

from cosim.sumo.network import Network
from cosim.sumo.quickest import quickest, route_to
from cosim.sumo.track import Track

SLOWEST = 0.1
"""Lowest speed assumed on a lane: a limit of 0 closes a lane [m/s]."""


def on_a_lane_off_the_route(track: Track) -> bool:
    """Return whether a vehicle is on a lane that leads off its route, so that it has to change lanes."""
    path = track.path
    return not path.leads_to_end and path.piece_at(track.along).end >= path.chain_end


def detour(network: Network, track: Track) -> tuple[str, ...]:
    """Return the quickest way on empty roads from the lane that a vehicle is on to the end of its route.

    Parameters
    ----------
    network
    track : where the vehicle is on its present route

    Returns
    -------
    Edges, starting with the present one; empty if the lane does not lead to the end of the route, or the
    vehicle is in a junction.
    """
    here, kind = track.path.piece_at(track.along).lane, track.route.vehicle_class
    if here.internal:
        return ()

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
    for begin in reached_from([here.name]):
        way = route_to(end, quickest(begin, lambda edge: reached_from(lanes_of(edge)), seconds))
        if way[0] == begin:
            ways.append(way)
    best = min(ways, key=lambda way: sum(map(seconds, way)), default=())
    return (here.edge, *best) if best else ()
