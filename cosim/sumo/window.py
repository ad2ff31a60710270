"""The window of sumo-gui: marks the egos and shows their plans."""

from __future__ import annotations

from controllers.interface import Decision, Perception, Plan
from cosim.step.loop import ToWorld
from cosim.step.world import Snapshot
from cosim.sumo.connection import Connection

Colour = tuple[int, int, int, int]

EGO: Colour = (0, 114, 178, 255)
HANDED_BACK: Colour = (153, 153, 153, 255)
"""Colour of an ego that SUMO drives for the moment."""
PLAN: Colour = (86, 180, 233, 255)
FALLBACK: Colour = (213, 94, 0, 255)
"""Colour of a plan that is the declared fallback."""
LAYER = 250.0
"""SUMO's layer of plans, above roads and vehicles."""
LINE_WIDTH = 0.4
"""Width of the lines that show plans [m]."""
VIEW = "View #0"
ZOOM = 900.0


class Window:
    """Colours egos, redraws their plans, and follows the first ego.

    None of this influences the simulation.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._colours: dict[str, Colour] = {}
        self._lines: dict[str, Colour] = {}
        """Colours of the plans shown, by ego."""
        self._followed = ""

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Draw the path that an ego has planned."""
        name = perception.ego.name
        with self._connection.reporting(f"drawing at {perception.ego.time:.2f} s"):
            if len(plan.along) < 2:
                self._erase(name)
                return
            points = [(float(x), float(y)) for x, y in to_world(name, plan.along, plan.across)]
            self._draw(name, points, PLAN if plan.solved else FALLBACK)

    def stepped(self, snapshot: Snapshot) -> None:
        """Colour new egos, and forget those that have left."""
        present = {ego.name for ego in snapshot.egos}
        with self._connection.reporting(f"drawing at {snapshot.time:.2f} s"):
            for name in [name for name in self._lines if name not in present]:
                self._erase(name)
            for name in [name for name in self._colours if name not in present]:
                del self._colours[name]
            for ego in snapshot.egos:
                colour = HANDED_BACK if ego.handed_back else EGO
                if self._colours.get(ego.name) != colour:
                    self._colours[ego.name] = colour
                    self._connection.sumo.vehicle.setColor(ego.name, colour)
            self._follow(sorted(present))

    def _follow(self, names: list[str]) -> None:
        if names and self._followed not in names:
            self._followed = names[0]
            gui = self._connection.sumo.gui
            gui.trackVehicle(VIEW, self._followed)
            gui.setZoom(VIEW, ZOOM)

    def _draw(self, name: str, points: list[tuple[float, float]], colour: Colour) -> None:
        polygon = self._connection.sumo.polygon
        line = line_name(name)
        if name not in self._lines:
            polygon.add(line, points, colour, False, "plan", LAYER, LINE_WIDTH)
        else:
            polygon.setShape(line, points)
            if self._lines[name] != colour:
                polygon.setColor(line, colour)
        self._lines[name] = colour

    def _erase(self, name: str) -> None:
        if self._lines.pop(name, None) is not None:
            self._connection.sumo.polygon.remove(line_name(name))


def line_name(ego: str) -> str:
    """Return the id of the polygon that shows an ego's plan.

    >>> line_name("ego_0")
    'plan of ego_0'
    """
    return f"plan of {ego}"
