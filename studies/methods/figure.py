"""Figure of safety against delay: one point per method, with intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib import colormaps
from matplotlib.figure import Figure

from studies.methods.against import OURS, Against
from studies.methods.answer import REFERENCES
from studies.methods.rows import Row

MARKERS = "osD^vP*X"
COLOURS = "tab10"


def draw(path: Path, rows: Mapping[str, Row], others: Sequence[Against]) -> None:
    """Draw contacts per 100 encounters, with their exact interval, over the difference of delays.

    Drivers that avoid nobody would compress the scale for all others. If they do not fit, they are drawn at
    the upper edge, and the legend says so.

    Parameters
    ----------
    path : path of the figure
    rows : row of each label over all conditions
    others : comparisons of every other method with ours; methods without a difference of delays are left out
    """
    figure = Figure(figsize=(8.5, 5.0), layout="constrained")
    axes = figure.add_subplot()
    delays = {OURS: (0.0, 0.0, 0.0)} | {
        one.method: _delay(one) for one in others if one.delay.difference is not None
    }
    shares = {
        label: (row.contacts / row.encounters, row.contact_share)
        for label, row in rows.items()
        if label in delays and row.contact_share
    }
    tops = {label: interval.high for label, (_, interval) in shares.items()}
    methods = [top for label, top in tops.items() if label not in REFERENCES]
    highest = 1.1 * max(methods or tops.values(), default=0.01)
    for number, (label, (share, interval)) in enumerate(shares.items()):
        delay, below, above = delays[label]
        beyond = share > highest
        reach = None if beyond else [[100.0 * (share - interval.low)], [100.0 * (interval.high - share)]]
        axes.errorbar(
            delay,
            100.0 * min(share, highest),
            xerr=[[below], [above]],
            yerr=reach,
            markersize=6.0,
            linestyle="none",
            linewidth=0.8,
            label=f"{label} ({100.0 * share:.1f}, not to scale)" if beyond else label,
            clip_on=not beyond,
            color=colormaps[COLOURS](number % 10),
            # A colour that is used again has another marker.
            marker=MARKERS[(number // 10 + number) % len(MARKERS)],
        )
    axes.axvline(0.0, color="0.8", linewidth=0.8, zorder=0)
    axes.set_xlabel(f"delay of a trip minus that of {OURS}, same condition and seed [s]")
    axes.set_ylabel("contacts per 100 entered encounters")
    axes.set_ylim(-3.0 * highest, 100.0 * highest)
    if shares:
        figure.legend(loc="outside right upper", fontsize=8, frameon=False)
    figure.savefig(path, dpi=120, metadata={"Software": None})


def _delay(one: Against) -> tuple[float, float, float]:
    """Return the difference, and how far its interval reaches below and above [s]."""
    difference, interval = one.delay.difference or 0.0, one.delay.interval
    if interval is None:
        return difference, 0.0, 0.0
    return difference, max(difference - interval.low, 0.0), max(interval.high - difference, 0.0)
