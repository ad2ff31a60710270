"""A film of an encounter from above: egos, pedestrians, vehicles and the planned path, in simulated time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, PolyCollection
from matplotlib.figure import Figure

from analysis.arrays import FloatArray
from analysis.errors import AnalysisError
from analysis.plots.ground import EGO, PERSON, PLAN, VEHICLE, draw_ground, limits, rectangle
from analysis.plots.plans import PlannedPath, read_plans
from analysis.plots.scene import Scene
from analysis.recording.tracks import Track

FORMATS = ("gif", "mp4")
FRAMES_PER_SECOND = 10
"""Largest frame rate; a run with longer steps has a lower one [1/s]."""
PLAN_LASTS_S = 1.0
"""A plan is shown until the next one, but not longer than this [s]."""
MARGIN_M = 6.0
WIDTH_IN = 8.0
DOTS_PER_INCH = 90


def has_ffmpeg() -> bool:
    """Return whether films can be written as mp4 here."""
    return bool(FFMpegWriter.isAvailable())


def frame_indices(scene: Scene) -> list[int]:
    """Return the fine indices of the frames: recorded instants, evenly spaced."""
    factor = scene.case.grid.factor
    every = factor * max(1, round(1.0 / (FRAMES_PER_SECOND * scene.case.run.step_s)))
    first = -(-scene.first // factor) * factor
    return list(range(first, scene.last + 1, every))


def write_film(scene: Scene, path: Path) -> int:
    """Write the film as ``.gif`` or ``.mp4``, depending on the suffix, and return the number of frames.

    A second of film is a second of simulated time.

    Raises
    ------
    AnalysisError
        If the plans cannot be read, or the window holds no recorded instant.
    """
    frames = frame_indices(scene)
    if not frames:
        raise AnalysisError(f"{scene.name}: too short to show")
    spacing = scene.case.grid.time[frames[-1]] - scene.case.grid.time[frames[0]]
    every_s = float(spacing) / (len(frames) - 1) if len(frames) > 1 else 1.0 / FRAMES_PER_SECOND
    film = Film(scene)
    writer = writer_for(path, every_s)
    # The writer chooses the format by the suffix, so only the folder is a temporary one.
    with TemporaryDirectory(dir=path.parent) as unfinished:
        part = Path(unfinished) / path.name
        with writer.saving(film.figure, str(part), DOTS_PER_INCH):
            for index in frames:
                film.show(index)
                writer.grab_frame()
        part.replace(path)
    return len(frames)


def writer_for(path: Path, every_s: float) -> AbstractMovieWriter:
    """Return the writer of a film whose frames are so far apart [s]."""
    writer = PillowWriter() if path.suffix.lower() == ".gif" else FFMpegWriter()
    rate = 1.0 / every_s
    if path.suffix.lower() == ".gif":
        # GIF counts hundredths of a second. The writer drops what is beyond whole milliseconds.
        rate = 1000.0 / (10.0 * round(100.0 * every_s) + 1e-6)
    writer.fps = float(f"{rate:.9g}")  # type: ignore[assignment]  # the stub says int, both take fractions
    return writer


class Film:
    """Draws one instant after the other; the ground is drawn only once."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        case = scene.case
        shown = [np.column_stack([one.x, one.y]) for one in (*scene.pieces(), *scene.persons())]
        self.low, self.high = limits(np.concatenate(shown), MARGIN_M)
        wide, tall = self.high - self.low
        self.figure = Figure(figsize=(WIDTH_IN, WIDTH_IN * float(tall / wide) + 1.2), layout="constrained")
        FigureCanvasAgg(self.figure)
        self.axes: Axes = self.figure.add_subplot()
        draw_ground(self.axes, case.run.areas)
        self.axes.set_aspect("equal")
        self.axes.set_xlim(self.low[0], self.high[0])
        self.axes.set_ylim(self.low[1], self.high[1])
        self.axes.set_xlabel("x [m]")
        self.axes.set_ylabel("y [m]")
        self.vehicles = list(case.vehicles)
        self.met = {one.person.name for one in scene.encounters}
        self.plans = read_plans(case.run.folder, scene.ego)
        self._plan_times = [plan.time_s for plan in self.plans]
        self._ttc = {
            round(float(time), 6): float(value)
            for _, times, values in scene.ttc()
            for time, value in zip(times, values, strict=True)
        }
        self._moving: list[PolyCollection | EllipseCollection] = []
        (self._plan_line,) = self.axes.plot([], [], color=PLAN, linewidth=2.0, zorder=3)
        # Reserves space for the title before the layout is fixed for all frames.
        self.axes.set_title(" \n ", fontsize=9, loc="left")
        self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")

    def show(self, index: int) -> None:
        """Draw the instant with a given fine index."""
        for artist in self._moving:
            artist.remove()
        case = self.scene.case
        egos = [track for track in case.egos if track.name == self.scene.ego]
        others = [track for track in case.egos if track.name != self.scene.ego]
        here = [track for track in case.persons if track.name in self.met]
        passers = [track for track in case.persons if track.name not in self.met]
        self._moving = [
            self._bodies(index, [*self.vehicles, *others], VEHICLE),
            self._bodies(index, egos, EGO),
            self._discs(index, passers, PERSON, 0.35),
            self._discs(index, here, PERSON, 1.0),
        ]
        for artist in self._moving:
            self.axes.add_collection(artist)
        time = float(case.grid.time[index])
        plan = self.plan_at(time)
        self._plan_line.set_data(*(np.zeros((0, 2)) if plan is None else plan.points).T)
        self.axes.set_title(self._caption(time, index, egos), fontsize=9, loc="left")

    def plan_at(self, time: float) -> PlannedPath | None:
        """Return the plan that was driven at a time [s]; ``None`` if no recent one was recorded."""
        number = bisect_right(self._plan_times, time + 1e-6) - 1
        if number < 0 or time - self._plan_times[number] > PLAN_LASTS_S:
            return None
        return self.plans[number]

    def _caption(self, time: float, index: int, egos: Sequence[Track]) -> str:
        parts = [f"{time:.1f} s"]
        for track in egos:
            if track.first <= index <= track.last:
                at = index - track.first
                parts += [f"{track.speed[at]:.1f} m/s", f"{track.acceleration[at]:+.1f} m/s²"]
        ttc = self._ttc.get(round(time, 6), float("nan"))
        parts.append(f"TTC {ttc:.1f} s" if np.isfinite(ttc) else "no collision course")
        return f"{self.scene.name}\n{', '.join(parts)}"

    def _bodies(self, index: int, tracks: Iterable[Track], color: str) -> PolyCollection:
        bodies: list[FloatArray] = []
        for track in tracks:
            at = index - track.first
            if 0 <= at < len(track.x):
                x, y = float(track.x[at]), float(track.y[at])
                bodies.append(rectangle(x, y, float(track.heading[at]), track.length, track.width))
        return PolyCollection(bodies, facecolors=color, edgecolors="black", linewidths=0.5, zorder=4)

    def _discs(self, index: int, tracks: Iterable[Track], color: str, alpha: float) -> EllipseCollection:
        places = [
            (track.x[index - track.first], track.y[index - track.first], track.width)
            for track in tracks
            if 0 <= index - track.first < len(track.x)
        ]
        widths = [width for _, _, width in places]
        return EllipseCollection(
            widths,
            widths,
            [0.0] * len(places),
            units="xy",
            offsets=np.array([place[:2] for place in places]).reshape(-1, 2),
            offset_transform=self.axes.transData,
            facecolors=color,
            edgecolors="black",
            linewidths=0.5,
            alpha=alpha,
            zorder=5,
        )
