"""A share of the measured traffic of an intersection is driven by vo_mpc; no ego loses its route."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from controllers.interface import Decision, Perception, Plan
from cosim.running.compose import Composition, compose
from cosim.running.request import RunRequest
from cosim.step import loop
from cosim.step.loop import ToWorld
from cosim.step.world import Snapshot

pytestmark = pytest.mark.sumo

Route = tuple[str, ...]


class RouteWatch:
    """Compares what SUMO has as the rest of each ego's route with the route that it came with."""

    def __init__(self) -> None:
        self.routes: dict[str, Route] = {}
        self.wrong: list[tuple[float, str, Route]] = []
        self.last: dict[str, tuple[float, str]] = {}
        self.teleports = 0

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Take no note of plans."""

    def stepped(self, snapshot: Snapshot) -> None:
        import libsumo

        self.teleports = snapshot.teleports
        vehicle = libsumo.vehicle
        for ego in snapshot.egos:
            here = vehicle.getRouteIndex(ego.name)
            route = self.routes.setdefault(ego.name, tuple(vehicle.getRoute(ego.name)))
            rest = tuple(vehicle.getRoute(ego.name)[here:])
            # Within a junction SUMO may take the ego to be on another way through it for some steps.
            if not vehicle.getLaneID(ego.name).startswith(":") and route[-len(rest) :] != rest:
                self.wrong.append((snapshot.time, ego.name, rest))
            self.last[ego.name] = (snapshot.time, ego.edge)


@pytest.fixture(
    params=[pytest.param(50.0, id="50 s"), pytest.param(600.0, id="ten minutes", marks=pytest.mark.slow)]
)
def composition(request: pytest.FixtureRequest) -> Iterator[Composition]:
    """The intersection at its first step."""
    composed = compose(RunRequest("braunschweig", "vo_mpc", ego_share=0.2, duration_s=request.param))
    yield composed
    composed.close()


@pytest.mark.long
def test_every_ego_keeps_its_route_and_leaves_at_its_end(composition: Composition) -> None:
    watch = RouteWatch()
    loop.run(composition.world, composition.drivers, watch)
    assert len(watch.routes) >= 5
    assert watch.wrong == []
    assert watch.teleports == 0
    gone = {name: edge for name, (time, edge) in watch.last.items() if time < composition.end_time - 0.5}
    assert gone
    assert gone == {name: watch.routes[name][-1] for name in gone}
