"""Routes that egos share, and that go when nobody is on them."""

from __future__ import annotations

from weakref import ref

import pytest

from cosim.errors import InputError
from cosim.sumo.bends import CAR
from cosim.sumo.network import Network
from cosim.sumo.shared_routes import KEPT, SharedRoutes


def test_egos_of_one_route_share_it_as_long_as_there_are_any(town: Network) -> None:
    routes = SharedRoutes(town)
    edges = (next(name for name in town.roads if town.allowed_lanes(name, "passenger")),)
    first = routes.route(edges, "passenger", CAR)
    assert routes.route(edges, "passenger", CAR) is first
    wider = [CAR._replace(radius=CAR.radius + one) for one in range(1, KEPT + 2)]
    others = [ref(routes.route(edges, "passenger", turning)) for turning in wider]
    assert routes.route(edges, "passenger", CAR) is first
    assert [one() is None for one in others] == [True] + [False] * KEPT


def test_a_route_that_cannot_be_driven_is_refused(town: Network) -> None:
    with pytest.raises(InputError, match="nowhere"):
        SharedRoutes(town).route(("nowhere",), "passenger", CAR)
