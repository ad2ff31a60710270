"""Elements of an SVG picture in the colours of light and dark pages; positions and sizes in pixels."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

LETTER = 0.62
"""Width of a letter of the font over its height; the widest usual monospace font has 0.61."""

_LIGHT = {"page": "#ffffff", "frame": "#eef2f5", "box": "#ffffff", "line": "#546e7a", "ink": "#1c262b"}
_DARK = {"page": "#1e2129", "frame": "#2a2f3a", "box": "#3a4250", "line": "#9fb4c0", "ink": "#eceff1"}

_SHAPES = """\
text { font-family: "DejaVu Sans Mono", Menlo, Consolas, monospace; text-anchor: middle }
.title { font-weight: bold }
.box, .frame { stroke-width: 1.2 }
.arrow { fill: none; stroke-width: 1.4 }
.thick { stroke-width: 2.4 }"""


def _colours(of: dict[str, str]) -> str:
    return (
        f".page {{ fill: {of['page']} }} text {{ fill: {of['ink']} }} .label {{ fill: {of['line']} }}\n"
        f".frame {{ fill: {of['frame']}; stroke: {of['frame']} }} "
        f".box {{ fill: {of['box']}; stroke: {of['line']} }}\n"
        f".arrow {{ stroke: {of['line']} }} .head {{ fill: {of['line']} }} "
        f".group {{ fill: none; stroke: {of['line']}; stroke-dasharray: 4 4 }}"
    )


def text_width(text: str, height: float) -> float:
    """Return the width of a text with letters of a height."""
    return len(text) * height * LETTER


def text(x: float, y: float, content: str, height: float, kind: str = "name") -> str:
    """Return a text around a point."""
    at = f'x="{x:.0f}" y="{y + 0.35 * height:.0f}" font-size="{height:g}"'
    return f'<text class="{kind}" {at}>{escape(content)}</text>'


def rectangle(x: float, y: float, width: float, height: float, kind: str) -> str:
    """Return a rectangle with round corners, given its upper left corner."""
    return f'<rect class="{kind}" x="{x:.0f}" y="{y:.0f}" width="{width:.0f}" height="{height:.0f}" rx="6"/>'


def arrow(points: Sequence[tuple[float, float]], kind: str = "arrow") -> str:
    """Return an arrow downwards; stretches to another x are curves that begin and end vertically."""
    (x, y), *others = points
    path = [f"M{x:.0f} {y:.0f}"]
    for to_x, to_y in others:
        if (x, y) == (to_x, to_y):
            continue  # the head would not know where to point
        middle = (y + to_y) / 2
        curve = f"C{x:.0f} {middle:.0f} {to_x:.0f} {middle:.0f} {to_x:.0f} {to_y:.0f}"
        path.append(f"V{to_y:.0f}" if f"{x:.0f}" == f"{to_x:.0f}" else curve)
        x, y = to_x, to_y
    return f'<path class="{kind}" d="{"".join(path)}" marker-end="url(#head)"/>'


def line(points: Sequence[tuple[float, float]], kind: str = "arrow") -> str:
    """Return an arrow of straight stretches."""
    path = "L".join(f"{x:.0f} {y:.0f}" for x, y in points)
    return f'<path class="{kind}" d="M{path}" marker-end="url(#head)"/>'


def picture(width: float, height: float, title: str, parts: Sequence[str]) -> str:
    """Return the file of a picture."""
    head = '<path class="head" d="M0 0L9 4.5L0 9Z"/>'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
        f'width="{width:.0f}" height="{height:.0f}" role="img">',
        f"<title>{escape(title)}</title>",
        f"<style>\n{_SHAPES}\n{_colours(_LIGHT)}",
        f"@media (prefers-color-scheme: dark) {{\n{_colours(_DARK)}\n}}\n</style>",
        '<defs><marker id="head" viewBox="0 0 9 9" refX="8" refY="4.5" markerWidth="9" markerHeight="9" '
        f'markerUnits="userSpaceOnUse" orient="auto">{head}</marker></defs>',
        rectangle(0, 0, width, height, "page"),
        *parts,
        "</svg>",
    ]
    return "\n".join(lines) + "\n"
