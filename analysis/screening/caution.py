"""A warning with the numbers of a ranking: SUMO's drivers strike more people than real drivers do."""

from __future__ import annotations

from collections.abc import Sequence

from analysis.tables.cells import Row


def caution(rows: Sequence[Row]) -> str:
    """Return a sentence of caution to show with a ranking; empty if nobody was struck.

    Parameters
    ----------
    rows
        Rows of crossings.csv.

    Examples
    --------
    >>> caution([{"n_collisions": 3, "entered_per_h": 50.0, "observed_h": 2.0}]).partition(":")[0]
    "SUMO's drivers struck the pedestrian in 3 of 100 encounters on the crossings (3.0 %)"
    """
    struck = sum(int(row["n_collisions"]) for row in rows)
    met = round(sum((row["entered_per_h"] or 0.0) * row["observed_h"] for row in rows))
    if not struck or not met:
        return ""
    return (
        f"SUMO's drivers struck the pedestrian in {struck} of {met} encounters on the crossings "
        f"({100.0 * struck / met:.1f} %): its models overlap where people would brake or step back. "
        "Severities rank crossings of this network; they are no crash rates"
    )
