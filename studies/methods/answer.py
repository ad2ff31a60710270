"""What a study of the methods found, in five sentences, from its numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from analysis.statistics.intervals import share_upper_bound
from analysis.statistics.paired import Comparison, compare_values, holm
from analysis.study.comparison_rows import pair_runs
from analysis.study.design import Study
from studies.methods.rows import Row

OURS = "vo_mpc"
MARGIN = 0.5
"""Of non-inferiority: preventable contacts per 100 encounters."""
ENOUGH = 150
"""Encounters that each cell is to have."""
REFERENCES = ("sumo", "septic_lane_change")
"""SUMO's own driver, and one that does not react to pedestrians: no methods of avoidance."""


def delays(study: Study, labels: Sequence[str]) -> dict[str, tuple[Comparison, float | None]]:
    """Return the difference of the delay against ours, paired by condition and seed, with Holm's p-value."""
    found = {}
    for label in labels:
        if label == OURS:
            continue
        each = [pair_runs(study, [condition], OURS, label) for condition in study.conditions]
        values = [
            (base.numbers["ego_delay_mean_s"], alt.numbers["ego_delay_mean_s"])
            for pairs in each
            for (base,), (alt,) in zip(pairs.base, pairs.alt, strict=True)
            if "ego_delay_mean_s" in base.numbers and "ego_delay_mean_s" in alt.numbers
        ]
        if values:
            base, alt = np.array(values).T
            found[label] = compare_values(base, alt)
    corrected = holm([one.p_value for one in found.values()])
    return {label: (one, p) for (label, one), p in zip(found.items(), corrected, strict=True)}


def front(rows: Mapping[str, Row]) -> list[str]:
    """Return the methods that no other one beats in both preventable contacts per encounter and delay."""
    points = {
        label: (row.preventable / row.encounters, row.delay)
        for label, row in rows.items()
        if row.encounters and row.delay is not None and label not in REFERENCES
    }
    return [
        label
        for label, (contacts, delay) in points.items()
        if not any(
            c <= contacts and d <= delay and (c, d) != (contacts, delay)
            for other, (c, d) in points.items()
            if other != label
        )
    ]


def sentences(study: Study, rows: Mapping[str, Row], fewest: int) -> list[str]:
    """Return the five sentences.

    Parameters
    ----------
    study : for the pairs
    rows : of all labels over all conditions
    fewest : encounters of the cell that has the fewest
    """
    return [
        _size(study, fewest),
        _contacts(rows),
        _non_inferior(rows),
        _on_the_front(study, rows),
        _acting(rows),
    ]


def _size(study: Study, fewest: int) -> str:
    seeds = len({run.seed for run in study.runs})
    cells = len(study.conditions)
    conditions = f"{cells} condition{'s' if cells > 1 else ''}"
    enough = "" if fewest >= ENOUGH else f", fewer than the {ENOUGH} that the whole study aims at"
    return (
        f"**How much was run.** {len(study.runs)} runs: {conditions}, {seeds} "
        f"seed{'s' if seeds > 1 else ''}; the smallest cell has {fewest} encounters{enough}."
    )


def _contacts(rows: Mapping[str, Row]) -> str:
    touched = {label: row for label, row in rows.items() if row.contacts}
    if not touched:
        return "**Contacts.** No method touched anybody."
    listed = ", ".join(
        f"`{label}` {row.contacts} ({row.preventable} preventable)" for label, row in touched.items()
    )
    encounters = sum(row.encounters for row in rows.values())
    return f"**Contacts.** In {encounters} encounters: {listed}; the others none."


def _non_inferior(rows: Mapping[str, Row]) -> str:
    row = rows.get(OURS)
    bound = share_upper_bound(row.preventable, row.encounters) if row is not None else None
    if row is None or bound is None:
        return f"**Non-inferiority.** `{OURS}` was not run."
    shown = 100.0 * bound <= MARGIN
    needed = math.ceil(math.log(0.05) / math.log(1.0 - MARGIN / 100.0))
    return (
        f"**Non-inferiority.** `{OURS}` had {row.preventable} preventable contacts in {row.encounters} "
        f"encounters; the upper bound of its share is {100.0 * bound:.2f} per 100, so that it is "
        f"{'' if shown else 'not '}shown to be within {MARGIN:g} per 100 of any other; a method that never "
        f"touches anybody is shown to be so from {needed} encounters on, and never from fewer."
    )


def _on_the_front(study: Study, rows: Mapping[str, Row]) -> str:
    best, differences = front(rows), delays(study, list(rows))
    slower = [
        f"`{label}` {one.difference:+.1f} s"
        for label, (one, p) in differences.items()
        if one.difference is not None and p is not None and p < 0.05
    ]
    how = " (paired by condition and seed, Holm's correction)"
    if all(p is None for _, p in differences.values()):
        told = "one run each is too little to test whether delays differ"
    elif slower:
        told = f"beyond chance, these differ in delay from `{OURS}`: {', '.join(slower)}{how}"
    else:
        told = f"no method's delay differs from that of `{OURS}` beyond chance{how}"
    listed = ", ".join(f"`{one}`" for one in best)
    return (
        f"**Safety against delay.** Beaten by no other method in both: {listed}; "
        f"`{OURS}` is {'' if OURS in best else 'not '}among them; {told}."
    )


def _acting(rows: Mapping[str, Row]) -> str:
    acts = {label: row.acts for label, row in rows.items() if row.acts is not None}
    if not acts:
        return "**Acting.** No run says whether its method acted."
    least = min(acts, key=lambda label: acts[label] or 0.0)
    missed = [label for label, share in acts.items() if share is not None and share < 0.5]
    bar = "every method reaches the bar of 50 %" if not missed else f"below 50 %: {', '.join(missed)}"
    return (
        f"**Acting.** Where its condition holds, each method's own plan is driven in at least "
        f"{100.0 * (acts[least] or 0.0):.0f} % of the plans (`{least}`); {bar}."
    )
