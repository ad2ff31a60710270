"""Routes that egos share, for as long as one is on them.

What a route knows of its lanes takes some megabytes. In a run of hours, with detours and routes that SUMO
chooses by traffic, there are ever new ones.
"""

from __future__ import annotations

from collections import deque
from weakref import WeakValueDictionary

from cosim.sumo.bends import Turning
from cosim.sumo.network import Network
from cosim.sumo.route import Route

KEPT = 16
"""So many are kept, for the next ego of a flow, though none is on them."""


class SharedRoutes:
    """Routes through a network, made on first use.

    Parameters
    ----------
    network
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self._routes: WeakValueDictionary[tuple[tuple[str, ...], str, Turning], Route] = WeakValueDictionary()
        self._latest: deque[Route] = deque(maxlen=KEPT)

    def route(self, edges: tuple[str, ...], vehicle_class: str, turning: Turning) -> Route:
        """Return a route for a vehicle class that turns so tightly.

        Raises
        ------
        InputError
            If it cannot be driven.
        """
        key = (edges, vehicle_class, turning)
        found = self._routes.get(key)
        if found is None:
            found = self._routes[key] = Route(self._network, edges, vehicle_class, turning)
            self._latest.append(found)
        return found
