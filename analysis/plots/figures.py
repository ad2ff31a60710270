"""All figures of a scene, written into a folder."""

from __future__ import annotations

import re
from pathlib import Path

from analysis.plots.plane import draw_plane
from analysis.plots.saving import save
from analysis.plots.scene import Scene
from analysis.plots.space_time import draw_space_time
from analysis.plots.traces import draw_traces

FIGURES = {"plane": draw_plane, "traces": draw_traces, "space-time": draw_space_time}
"""Functions that draw the figures, by the end of the file's name."""


def draw_figures(scene: Scene, folder: Path, kind: str) -> list[Path]:
    """Write the figures of a scene as ``png`` or ``svg``, and return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    stem = re.sub(r"[^\w.-]", "_", scene.ego if scene.number is None else f"encounter-{scene.number}")
    return [save(draw(scene), folder / f"{stem}-{name}.{kind}") for name, draw in FIGURES.items()]
