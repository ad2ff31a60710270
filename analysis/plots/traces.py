"""Speed, acceleration, heading and TTC over time, one below the other."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.arrays import FloatArray
from analysis.plots.ground import EGO, PERSON
from analysis.plots.scene import Scene

TTC_SHOWN_S = 10.0
"""Larger values are cut off [s]."""
LEAST_TURN_RAD = 0.1
"""The axis of the heading spans at least this, so that noise does not look like a turn [rad]."""


def draw_traces(scene: Scene) -> Figure:
    """Return the figure."""
    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    speed, acceleration, heading, ttc = figure.subplots(4, 1, sharex=True)
    limit = scene.case.run.egos.numbers["speed_limit_mps"]
    for piece in scene.pieces():
        track, part, time = piece.track, piece.part, piece.time
        speed.plot(time, track.speed[part], color=EGO, label="ego")
        speed.plot(time, limit[track.rows[part]], color="#707070", linestyle="--", label="limit")
        acceleration.plot(time, track.acceleration[part], color=EGO)
        heading.plot(time, track.heading[part], color=EGO)
    for _, time, values in scene.ttc():
        if np.isfinite(values).any():
            ttc.plot(time, values, color=PERSON, linewidth=1.2)
            _mark_least(ttc, time, values)
    for contact in scene.case.contacts:
        if scene.case.encounters[contact.encounter] in scene.encounters:
            ttc.axvline(contact.time, color="black", linewidth=1.0)
            ttc.annotate("contact", (contact.time, 0.9 * TTC_SHOWN_S), fontsize=7)
    acceleration.axhline(0.0, color="#707070", linewidth=0.6)
    if not ttc.lines:
        ttc.text(0.5, 0.5, "no collision course", transform=ttc.transAxes, ha="center", fontsize=8)
    low, high = heading.get_ylim()
    middle, half = 0.5 * (low + high), max(0.5 * (high - low), 0.5 * LEAST_TURN_RAD)
    heading.set_ylim(middle - half, middle + half)
    speed.set_ylim(bottom=0.0)
    ttc.set_ylim(0.0, TTC_SHOWN_S)
    speed.set_ylabel("speed [m/s]")
    acceleration.set_ylabel("acceleration [m/s²]")
    heading.set_ylabel("heading [rad]")
    ttc.set_ylabel("TTC [s]")
    ttc.set_xlabel("time [s]")
    ttc.set_xlim(scene.begin_s, scene.end_s)
    handles, labels = speed.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    speed.legend(unique.values(), unique.keys(), frameon=False, fontsize=8)
    speed.set_title(scene.name, fontsize=9)
    return figure


def _mark_least(axes: Axes, time: FloatArray, values: FloatArray) -> None:
    at = int(np.nanargmin(values))
    if values[at] <= TTC_SHOWN_S:
        axes.plot(time[at], values[at], "v", color=PERSON, markersize=4.0)
        text = f"{values[at]:.2f} s"
        axes.annotate(text, (time[at], values[at]), xytext=(3, 3), textcoords="offset points", fontsize=6)
