"""Figures of the six cases of the intermediate speed, and of the classic planner's chatter in detail."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from controllers.speed_plans.intermediate_speed import plan_intermediate, safe_distance
from controllers.speed_plans.trapezoid_profile import PlanningLimits, Situation
from studies.papers.intermediate_speed.drives import Driven

BLUE: Final = "#0072B2"
VERMILION: Final = "#D55E00"
GREY: Final = "#777777"
CASES: Final = {
    "1": (30.0, 10.0, 5.0),
    "2": (60.0, 10.0, 5.0),
    "3": (20.0, 2.0, 5.0),
    "4": (19.0, 3.0, 5.0),
    "5": (10.0, 8.0, 5.0),
    "6": (4.0, 4.0, 5.0),
}
"""Gap [m], speed and the obstacle's speed [m/s] of each case."""


def cases(limits: PlanningLimits) -> dict[str, str]:
    """Return the case that the planner assigns to each situation."""
    return {name: plan_intermediate(Situation(*state), limits).case for name, state in CASES.items()}


def draw_cases(path: Path, limits: PlanningLimits) -> None:
    """Draw the planned speed and the gap of each case."""
    figure = Figure(figsize=(11.0, 6.4), layout="constrained")
    for axes, (gap, speed, other) in zip(figure.subplots(2, 3).flat, CASES.values(), strict=True):
        plan = plan_intermediate(Situation(gap, speed, other), limits)
        lasts = sum(one.duration for one in plan.profile.segments)
        times = np.linspace(0.0, 1.15 * max(lasts, 0.5), 300)
        driven, planned, _ = plan.profile.sampled(times)
        axes.plot(times, planned, color=BLUE, label="planned speed [m/s]")
        axes.axhline(other, color=GREY, linestyle="--", label="obstacle [m/s]")
        axes.plot(times, gap + other * times - driven, ":", color=VERMILION, label="gap [m]")
        axes.axhline(safe_distance(other, limits), color=VERMILION, linewidth=0.5, label="safe distance [m]")
        axes.set_title(
            f"case {plan.case}: gap {gap:g} m, {speed:g} m/s behind {other:g} m/s", loc="left", fontsize=9
        )
        axes.set_xlabel("time [s]")
        axes.set_ylim(0.0, None)
    handles = axes.get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def draw_chatter(path: Path, classic: Driven, new: Driven) -> None:
    """Draw speed and acceleration behind the moving obstacle between 50 and 54 s."""
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    speeds, pushes = figure.subplots(2, 1, sharex=True)
    for name, color, drive in (("classic", VERMILION, classic), ("intermediate speed", BLUE, new)):
        shown = (drive.time >= 50.0) & (drive.time <= 54.0)
        speeds.plot(drive.time[shown], drive.speed[shown], color=color, label=name)
        pushes.plot(drive.time[shown], drive.acceleration[shown], color=color, drawstyle="steps-post")
    speeds.set_ylabel("speed [m/s]")
    pushes.set_ylabel("acceleration [m/s²]")
    pushes.set_xlabel("time [s]")
    speeds.legend(frameon=False)
    figure.savefig(path, dpi=110, metadata={"Software": None})
