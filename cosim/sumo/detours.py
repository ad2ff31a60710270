"""Another way to its destination for an ego that has missed its lane, taken as a driver would take it.

At the end of a lane that leads off its route an ego waits for a gap beside it. SUMO's own vehicles wait there
until they are teleported; an ego never is, and whoever is behind it would wait as long.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import shortest_path

from cosim.sumo.network import Network
from cosim.sumo.track import Track

MISSED = 30.0
"""An ego that has stood for so long at the end of such a lane takes another way [s]."""
AT_THE_END = 15.0
"""An ego this near the end of such a lane stands for want of a gap beside it [m]."""


def at_the_end_of_a_lane_off_the_route(track: Track) -> bool:
    """Return whether a vehicle is where its lane leads off its route, and it can only change lanes."""
    path = track.path
    return not path.leads_to_end and path.chain_end - track.along < AT_THE_END


class Detours:
    """Finds the quickest ways on empty roads.

    SUMO's own ``findRoute`` is not asked: called while egos are driven it makes libsumo 1.28 crash later on.
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self._roads = {name: number for number, name in enumerate(network.roads)}
        self._names = list(self._roads)
        self._times: dict[str, csr_array[np.float64, tuple[int, int]]] = {}

    def from_here(self, track: Track) -> tuple[str, ...]:
        """Return the edges from the present one to the route's end along which the vehicle's lane leads.

        Parameters
        ----------
        track : where the vehicle is on its route so far

        Returns
        -------
        Empty if the lane does not lead to the route's end, or the vehicle is in a junction.
        """
        lane, kind = track.path.piece_at(track.along).lane, track.route.vehicle_class
        if lane.internal:
            return ()
        if kind not in self._times:
            self._times[kind] = self._driving_times(kind)
        end = self._roads[track.route.edges[-1]]
        left, onward = shortest_path(self._times[kind], "D", indices=end, return_predecessors=True)
        begins = [self._roads[edge] for edge in self._reached_from(lane.name, kind)]
        at = min(begins, key=lambda edge: float(left[edge] + self._time(edge, kind)), default=end)
        if not begins or not np.isfinite(left[at]):
            return ()
        edges = [lane.edge, self._names[at]]
        while at != end:
            at = int(onward[at])
            edges.append(self._names[at])
        return tuple(edges)

    def _reached_from(self, lane: str, kind: str) -> list[str]:
        """Return the edges that a lane leads to, each once."""
        connections = self._network.connections.get(lane, ())
        passable = (one for one in connections if self._network.passable(one, kind))
        return list(dict.fromkeys(self._network.lanes[one.target].edge for one in passable))

    def _time(self, road: int, kind: str) -> float:
        """Return how long an edge takes at its limit [s]."""
        edge = self._names[road]
        lanes = [
            self._network.lanes[self._network.edges[edge][index]]
            for index in self._network.allowed_lanes(edge, kind)
        ]
        return min(lane.length / lane.speed for lane in lanes)

    def _driving_times(self, kind: str) -> csr_array[np.float64, tuple[int, int]]:
        """Return how long each edge (row) takes after another (column), for a search from the end [s]."""
        pairs = {
            (self._roads[edge], number)
            for name, number in self._roads.items()
            for index in self._network.allowed_lanes(name, kind)
            for edge in self._reached_from(self._network.edges[name][index], kind)
        }
        edges, before = np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2).T
        times = np.array([self._time(int(edge), kind) for edge in edges], dtype=np.float64)
        return csr_array((times, (edges, before)), shape=(len(self._names), len(self._names)))
