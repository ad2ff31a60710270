"""Routes that egos share, kept for as long as an ego is on them.

The data of a route and its lanes take some megabytes. A run of hours, with detours and routes that SUMO
chooses by traffic, needs new routes all the time.
"""

from __future__ import annotations

from collections import deque
from weakref import WeakValueDictionary

from cosim.sumo.bends import Turning
from cosim.sumo.network import Network
from cosim.sumo.route import Route

KEPT = 16
"""This many of the latest routes are kept for the next ego of a flow, even if no ego is on them."""


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
        """Return a route for vehicles of a class that turn this tightly.

        Raises
        ------
        InputError
            If the route cannot be driven.
        """
        key = (edges, vehicle_class, turning)
        found = self._routes.get(key)
        if found is None:
            found = self._routes[key] = Route(self._network, edges, vehicle_class, turning)
            self._latest.append(found)
        return found
