"""What commands print of real tracks: how well they lie on the network, and what was assumed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table

    from cosim.tracks.fit import ClassFit
    from cosim.tracks.judging import Judged

POOR_SHARE = 0.9
"""Fewer samples of a class that lie where they should are noted."""


def fit_table(fits: Sequence[ClassFit]) -> Table:
    """Return the table of classes: on a lane is within 1.0 m of its axis and 20° of its heading."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for number, head in enumerate(
        ("class", "tracks", "moving samples", "on a lane", "of tracks", "median [m]")
    ):
        table.add_column(head, justify="right" if number else "left")
    for one in fits:
        table.add_row(
            one.kind,
            str(one.n_tracks),
            str(one.n_samples),
            _percent(one.share_samples),
            _percent(one.share_tracks),
            "–" if one.median_m != one.median_m else f"{one.median_m:.2f}",
        )
    return table


def tracks_notes(done: Judged) -> list[str]:
    """Return what a user has to know, in one line each."""
    notes = []
    if done.assumed_bodies:
        notes.append(
            "lengths and widths of vehicles are assumed, not recorded: distances and PET depend on them"
        )
    for one in done.fits:
        if one.share_samples < POOR_SHARE:
            where = "on the ground for pedestrians" if one.kind == "pedestrian" else "on a lane"
            notes.append(
                f"{_percent(one.share_samples)} of the samples of {one.kind} are {where}: see tracks_fit.csv"
            )
    notes.append("signals are not in the tracks: whether somebody walked on red is not known")
    return notes


def _percent(share: float) -> str:
    return "–" if share != share else f"{100.0 * share:.1f} %"
