"""Writes figures so that the same run gives the same bytes."""

from __future__ import annotations

import io
import re
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from analysis.files import completing

DOTS_PER_INCH = 150


def save(figure: Figure, path: Path) -> Path:
    """Write a figure into a PNG or SVG file, depending on the suffix, and return the path."""
    # Otherwise SVG has random ids and letters as outlines, and both formats contain date and version.
    with matplotlib.rc_context({"svg.hashsalt": "cosim", "svg.fonttype": "none"}):
        metadata = {"Date": None} if path.suffix.lower() == ".svg" else {"Software": None}
        with completing(path) as part:
            figure.savefig(part, dpi=DOTS_PER_INCH, format=path.suffix[1:].lower(), metadata=metadata)
    return path


def svg_text(figure: Figure) -> str:
    """Return a figure as an SVG element for a page."""
    text = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": "cosim", "svg.fonttype": "none"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    return re.sub(r"^.*?(?=<svg)", "", text.getvalue(), flags=re.DOTALL)
