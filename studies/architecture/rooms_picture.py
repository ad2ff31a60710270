"""The picture of the rooms: packages as frames, their rooms on floors, an arrow for what is imported."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

from studies.architecture import svg
from studies.architecture.layout import Layout, Spot, arrange
from studies.architecture.rooms import Box, House, Package

NAME, SMALL = 15.0, 13.0
"""Height of the letters of a sub-package's and of a module's name [px]."""
LINE_LETTERS = 22
"""Longest line of a box of several names; one name may be longer."""
MARGIN, BETWEEN_PACKAGES = 13.0, 46.0
BETWEEN_FLOORS = 28.0


def draw(house: House) -> str:
    """Return the picture as SVG."""
    rows = [[_Frame(package) for package in row] for row in house.rows]
    inner = max(sum(frame.width for frame in row) + MARGIN * (len(row) - 1) for row in rows)
    width = inner + 2 * MARGIN
    parts: list[str] = []
    top = MARGIN
    corners: dict[str, tuple[_Frame, float, float]] = {}
    for row in rows:
        left = (width - sum(frame.width for frame in row) - MARGIN * (len(row) - 1)) / 2
        for frame in row:
            corners[frame.package.name] = frame, left, top
            parts += frame.drawn(left, top)
            left += frame.width + MARGIN
        top += max(frame.height for frame in row) + BETWEEN_PACKAGES
    for number, (start, end) in enumerate(house.arrows):
        parts.append(_between(corners[start], corners[end], _port(house.arrows, number, corners)))
    return svg.picture(width, top - BETWEEN_PACKAGES + MARGIN, "Packages, rooms and imports", parts)


class _Frame:
    """One package, measured and ready to be drawn anywhere."""

    def __init__(self, package: Package) -> None:
        self.package = package
        boxes = {box: _lines(box) for floor in package.floors for box in floor}
        self.lines = boxes
        self.widths = {
            box: max(svg.text_width(line, _letters(box)) for line in boxes[box]) + 10 for box in boxes
        }
        self.layout: Layout | None = None
        title = svg.text_width(package.name, NAME) + 2 * MARGIN
        self.width, self.height = title, NAME + 2 * MARGIN
        self.tops: list[float] = []
        self.heights = [max(self._height(box) for box in floor) for floor in package.floors]
        if package.floors:
            self.layout = arrange(package.floors, package.arrows, self.widths)
            self.width = max(title, self.layout.width + 2 * MARGIN)
            first = NAME + 2 * MARGIN
            self.tops = list(
                accumulate(self.heights[:-1], lambda y, h: y + h + BETWEEN_FLOORS, initial=first)
            )
            self.height = self.tops[-1] + self.heights[-1] + MARGIN

    def drawn(self, left: float, top: float) -> list[str]:
        """Return the elements with the upper left corner at a point."""
        parts = [
            svg.rectangle(left, top, self.width, self.height, "frame"),
            svg.text(left + self.width / 2, top + MARGIN + NAME / 2, self.package.name, NAME, "title"),
        ]
        if self.layout is None:
            return parts
        shift = left + (self.width - self.layout.width) / 2
        parts += self._arrows(self.layout, shift, top)
        for floor, y, height in zip(self.package.floors, self.tops, self.heights, strict=True):
            for box in floor:
                x, wide = self.layout.centres[box] + shift, self.widths[box]
                high = self._height(box)
                parts.append(svg.rectangle(x - wide / 2, top + y + (height - high) / 2, wide, high, "box"))
                step = _letters(box) + 4
                first = top + y + height / 2 - step * (len(self.lines[box]) - 1) / 2
                parts += [
                    svg.text(x, first + number * step, line, _letters(box))
                    for number, line in enumerate(self.lines[box])
                ]
        return parts

    def _arrows(self, layout: Layout, shift: float, top: float) -> list[str]:
        floor_of = {box: number for number, floor in enumerate(self.package.floors) for box in floor}
        drawn = []
        for route in layout.routes:
            start, end = route[0], route[-1]
            assert isinstance(start, Box)
            assert isinstance(end, Box)
            floor = floor_of[start]
            x, y = self._port(start, route[1], leaving=True), self.tops[floor] + self.heights[floor]
            points = [(x, y - (self.heights[floor] - self._height(start)) / 2), (x, y)]
            for number, point in enumerate(route[1:-1], floor + 1):
                x, y = layout.centres[point], self.tops[number]
                points += [(x, y), (x, y + self.heights[number])]
            floor = floor_of[end]
            x, y = self._port(end, route[-2], leaving=False), self.tops[floor]
            points += [(x, y), (x, y + (self.heights[floor] - self._height(end)) / 2)]
            drawn.append(svg.arrow([(x + shift, y + top) for x, y in points]))
        return drawn

    def _height(self, box: Box) -> float:
        return 10 + len(self.lines[box]) * (_letters(box) + 4)

    def _port(self, box: Box, other: Spot, *, leaving: bool) -> float:
        """Return where the arrow to or from a spot touches a box: side by side in the order of the others."""
        assert self.layout is not None
        centres, routes = self.layout.centres, self.layout.routes
        others = [route[1] for route in routes if route[0] == box]
        if not leaving:
            others = [route[-2] for route in routes if route[-1] == box]
        others.sort(key=centres.__getitem__)
        step = min(22.0, (self.widths[box] - 16) / max(1, len(others)))
        return centres[box] + (others.index(other) - (len(others) - 1) / 2) * step


def _port(
    arrows: Sequence[tuple[str, str]], number: int, corners: dict[str, tuple[_Frame, float, float]]
) -> float:
    """Return how far from the middle of its package an arrow begins [px]."""
    others = [arrow[1] for arrow in arrows if arrow[0] == arrows[number][0]]
    others.sort(key=lambda name: corners[name][1])
    return (others.index(arrows[number][1]) - (len(others) - 1) / 2) * 40.0


def _between(start: tuple[_Frame, float, float], end: tuple[_Frame, float, float], port: float) -> str:
    frame, left, top = start
    to_frame, to_left, to_top = end
    begin = (left + frame.width / 2 + port, top + frame.height)
    return svg.arrow([begin, (to_left + to_frame.width / 2, to_top)], "arrow thick")


def _letters(box: Box) -> float:
    return NAME if box.is_package else SMALL


def _lines(box: Box) -> list[str]:
    lines: list[str] = []
    for name in box.names:
        if lines and len(lines[-1]) + 2 + len(name) <= LINE_LETTERS:
            lines[-1] += f"  {name}"
        else:
            lines.append(name)
    return lines
