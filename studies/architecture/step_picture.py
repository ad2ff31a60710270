"""The picture of the step: a lane for each protocol, its methods in the order of their calls."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby, pairwise

from studies.architecture import svg
from studies.architecture.step import Call

NAME, SMALL = 16.0, 13.0
"""Height of the letters of names, and of everything else [px]."""
MARGIN, LANE, BETWEEN_LANES = 16.0, 232.0, 14.0
HEADER, ROW, BOX_HEIGHT, BOX_WIDTH = 70.0, 84.0, 36.0, 116.0
LEFT = 56.0
"""Left edge of the first lane; the arrow back to the first call is left of it."""


def draw(calls: Sequence[Call]) -> str:
    """Return the picture as SVG."""
    lanes = list(dict.fromkeys((call.protocol, call.module) for call in calls))
    centre = {lane[0]: LEFT + LANE / 2 + at * (LANE + BETWEEN_LANES) for at, lane in enumerate(lanes)}
    places = [(centre[call.protocol], HEADER + ROW * (row + 0.5)) for row, call in enumerate(calls)]
    width = LEFT + len(lanes) * (LANE + BETWEEN_LANES) - BETWEEN_LANES + MARGIN
    bottom = HEADER + ROW * len(calls)
    parts: list[str] = []
    for name, module in lanes:
        x = centre[name]
        parts += [
            svg.rectangle(x - LANE / 2, MARGIN, LANE, bottom - MARGIN, "frame"),
            svg.text(x, MARGIN + 20, name, NAME, "title"),
            svg.text(x, MARGIN + 42, module, SMALL, "label"),
        ]
    parts += _loops(calls, width)
    for (here, there), call in zip(pairwise(places), calls[1:], strict=True):
        parts += _handed(here, there, call.given)
    parts += _back(places, bottom, calls[0].loops[0])
    for (x, y), call in zip(places, calls, strict=True):
        parts.append(svg.rectangle(x - BOX_WIDTH / 2, y - BOX_HEIGHT / 2, BOX_WIDTH, BOX_HEIGHT, "box"))
        parts.append(svg.text(x, y, call.method, NAME, "title"))
    return svg.picture(width, bottom + 44, "The calls of one step and what they are given", parts)


def _loops(calls: Sequence[Call], width: float) -> list[str]:
    """Return a dashed frame around the calls of every loop inside the outermost one."""
    parts = []
    deepest = max(len(call.loops) for call in calls)
    for depth in range(1, deepest):
        for loop, rows in groupby(enumerate(calls), key=lambda row: row[1].loops[depth : depth + 1]):
            numbers = [number for number, _ in rows]
            if loop:
                inset = 6.0 * depth
                top = HEADER + ROW * numbers[0] + inset
                high = ROW * len(numbers) - 2 * inset
                wide = width - LEFT - MARGIN - 2 * inset
                parts.append(svg.rectangle(LEFT + inset, top, wide, high, "group"))
                at = LEFT + inset + 10 + svg.text_width(loop[0], SMALL) / 2
                parts.append(svg.text(at, top + 14, loop[0], SMALL, "label"))
    return parts


def _handed(here: tuple[float, float], there: tuple[float, float], given: Sequence[str]) -> list[str]:
    """Return the arrow between two calls, with what the second is given."""
    (x, y), (to_x, to_y) = here, there
    top = to_y - BOX_HEIGHT / 2
    if x == to_x:
        middle = (y + BOX_HEIGHT / 2 + top) / 2 - (SMALL + 3) * (len(given) - 1) / 2
        labels = [
            svg.text(x + 10 + svg.text_width(name, SMALL) / 2, middle + number * (SMALL + 3), name, SMALL)
            for number, name in enumerate(given)
        ]
        return [svg.line([(x, y + BOX_HEIGHT / 2), (x, top)]), *labels]
    edge = x + BOX_WIDTH / 2 * (1 if to_x > x else -1)
    label = svg.text((edge + to_x) / 2, y - SMALL * 0.8, ", ".join(given), SMALL)
    return [svg.line([(edge, y), (to_x, y), (to_x, top)]), *([label] if given else [])]


def _back(places: Sequence[tuple[float, float]], bottom: float, loop: str) -> list[str]:
    """Return the arrow from the last call back to the first, with the loop's first line."""
    (first_x, first_y), (last_x, last_y) = places[0], places[-1]
    x, y = LEFT - 28, bottom + 14
    corners = [
        (last_x, last_y + BOX_HEIGHT / 2),
        (last_x, y),
        (x, y),
        (x, first_y),
        (first_x - BOX_WIDTH / 2, first_y),
    ]
    return [
        svg.line(corners),
        svg.text(x + 4 + svg.text_width(loop, SMALL) / 2, y + 16, loop, SMALL, "label"),
    ]
