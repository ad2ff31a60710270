"""Picture of an ego's surroundings from above, as an array of colours."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cosim.gym.session import Session
from cosim.presentation.pictures import require_matplotlib
from cosim.step.world import EgoTruth, MapArea

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE_IN = (8.0, 4.0)
DOTS_PER_INCH = 80
AHEAD, BEHIND, BESIDE = 55.0, 25.0, 20.0
"""Distances shown in front of, behind and beside the ego [m]."""
COLOURS = {"lane": "#d4d4d4", "crossing": "#f0e7b0", "walkingarea": "#e6efe6"}


def picture(session: Session, name: str) -> NDArray[np.uint8]:
    """Return the picture, with the ego's direction of travel to the right; shape (height, width, 3).

    Raises
    ------
    InputError
        If matplotlib is missing.
    """
    require_matplotlib("render_mode='rgb_array'")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE_IN, dpi=DOTS_PER_INCH)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(-BEHIND, AHEAD)
    axes.set_ylim(-BESIDE, BESIDE)
    snapshot = session.look()
    ego = next((one for one in snapshot.egos if one.name == name), None)
    if ego is not None:
        for area in session.map_areas():
            _area(axes, area, ego)
        for other in snapshot.egos:
            colour = "#c0392b" if other is ego else "#2c5aa0"
            _body(axes, ego, other.x, other.y, other.heading, other.body.length, other.body.width, colour)
        cars = snapshot.vehicles
        for row in range(len(cars.names)):
            x, y, heading = float(cars.x[row]), float(cars.y[row]), float(cars.heading[row])
            _body(axes, ego, x, y, heading, float(cars.length[row]), float(cars.width[row]), "#5d6d7e")
        people = snapshot.persons
        if people.names:
            places = _seen(np.column_stack([people.x, people.y]), ego)
            axes.scatter(places[:, 0], places[:, 1], s=30.0, c="#1e8449", zorder=4)
    drawn: Any = canvas  # without annotations
    drawn.draw()
    return np.asarray(drawn.buffer_rgba())[:, :, :3].copy()


def _seen(points: NDArray[np.float64], ego: EgoTruth) -> NDArray[np.float64]:
    """Return points of the world in the ego's frame: distances forward and to the left."""
    dx, dy = points[:, 0] - ego.x, points[:, 1] - ego.y
    cos, sin = np.cos(ego.heading), np.sin(ego.heading)
    return np.column_stack([dx * cos + dy * sin, dy * cos - dx * sin])


def _area(axes: Axes, area: MapArea, ego: EgoTruth) -> None:
    line = _seen(area.shape, ego)
    if area.width > 0.0:
        shape = shapely.buffer(shapely.LineString(line), 0.5 * area.width, cap_style="flat")
    else:
        shape = shapely.Polygon(line) if len(line) > 2 else shapely.Polygon()
    for part in shapely.get_parts(shape):
        axes.fill(*np.asarray(part.exterior.coords).T, facecolor=COLOURS.get(area.kind, "#eeeeee"), zorder=1)


def _body(
    axes: Axes,
    ego: EgoTruth,
    x: float,
    y: float,
    heading: float,
    length: float,
    width: float,
    colour: str,
) -> None:
    corners = np.array([(0.0, 0.5), (0.0, -0.5), (-1.0, -0.5), (-1.0, 0.5)]) * (length, width)
    cos, sin = np.cos(heading), np.sin(heading)
    world = np.column_stack([x + corners @ (cos, -sin), y + corners @ (sin, cos)])
    axes.fill(*_seen(world, ego).T, facecolor=colour, zorder=3)
