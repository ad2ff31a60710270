"""The findings of a study of the methods in five sentences, made from its numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from analysis.study.design import Study
from studies.methods.against import ASSUMED, MARGIN, OURS, Against, needed, power
from studies.methods.rows import Row

ENOUGH = 150
"""Number of encounters that each cell should have."""
REFERENCES = ("sumo", "septic_lane_change")
"""SUMO's own driver, and one that does not react to pedestrians; neither is a method of avoidance."""


def front(rows: Mapping[str, Row]) -> list[str]:
    """Return the methods that no other method beats in both preventable contacts per encounter and delay."""
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


def sentences(
    study: Study, rows: Mapping[str, Row], fewest: int, others: Sequence[Against], planned: int = 0
) -> list[str]:
    """Return the five sentences.

    Parameters
    ----------
    study : what was run
    rows : rows of all labels over all conditions
    fewest : number of encounters of the cell with the fewest
    others : comparisons of every other method with ours
    planned : number of runs of the whole study; 0 if it is not known
    """
    return [
        _size(study, fewest, planned),
        _contacts(rows),
        _non_inferior(rows, others),
        _on_the_front(rows, others),
        _acting(rows),
    ]


def _size(study: Study, fewest: int, planned: int) -> str:
    of_each = seeds_of(study).values()
    fewest_seeds, most_seeds = min(of_each, default=0), max(of_each, default=0)
    seeds = f"{most_seeds} seed{'s' if most_seeds > 1 else ''}"
    seeds = seeds if fewest_seeds == most_seeds else f"{fewest_seeds} to {seeds} each"
    cells = len(study.conditions)
    conditions = f"{cells} condition{'s' if cells > 1 else ''}"
    enough = "" if fewest >= ENOUGH else f", fewer than the {ENOUGH} that the whole study aims at"
    run = counted(len(study.runs), planned)
    return (
        f"**How much was run.** {run[0].upper()}{run[1:]}: {conditions}, {seeds}; the smallest cell "
        f"has {fewest} encounters{enough}."
    )


def seeds_of(study: Study) -> Counter[str]:
    """Return the number of seeds of each condition, by its id."""
    return Counter(condition for condition, _ in {(run.condition_id, run.seed) for run in study.runs})


def counted(run: int, planned: int) -> str:
    """Say how many runs there are, and how many the whole study has; 0 if that is not known.

    >>> counted(810, 1350)
    '810 runs of the 1,350 of the whole study'
    >>> counted(1380, 1350)
    'the 1,350 runs of the whole study and 30 with further seeds'
    """
    if not planned:
        return f"{run:,} runs"
    if run <= planned:
        return f"{run:,} runs of the {planned:,} of the whole study"
    return f"the {planned:,} runs of the whole study and {run - planned:,} with further seeds"


def _contacts(rows: Mapping[str, Row]) -> str:
    touched = {label: row for label, row in rows.items() if row.contacts}
    if not touched:
        return "**Contacts.** No method touched anybody."
    listed = ", ".join(
        f"`{label}` {row.contacts} ({row.preventable} preventable)" for label, row in touched.items()
    )
    encounters = sum(row.encounters for row in rows.values())
    return f"**Contacts.** In {encounters:,} entered encounters: {listed}; the others none."


def _non_inferior(rows: Mapping[str, Row], others: Sequence[Against]) -> str:
    row = rows.get(OURS)
    known = [one for one in others if one.bound is not None]
    if row is None or not known:
        return f"**Non-inferiority.** `{OURS}` was not run beside any other."
    missed = [
        f"`{one.method}` ({one.bound:+.2f})" for one in known if one.bound is not None and not one.shown
    ]
    shown = [f"`{one.method}`" for one in known if one.shown]
    more = f"to have less than {MARGIN:g} per 100 more than"
    yes = f"shown {more} {', '.join(shown) if missed else 'every other method'}" if shown else ""
    no = f"not shown {more} {', '.join(missed)}: upper bound of the difference in brackets" if missed else ""
    told = ", and ".join(filter(None, (yes, no)))
    chance = power(row.encounters, ASSUMED)
    return (
        f"**Non-inferiority.** With {row.preventable} preventable contact{'s' * (row.preventable != 1)} in "
        f"{row.encounters:,} entered encounters, `{OURS}` is {told}; were {100 * ASSUMED:g} per 100 the "
        f"truth for both, a study of this size would show it with a power of {chance:.0%}, and of 80 % "
        f"from {needed(ASSUMED):,} encounters a method on."
    )


def _on_the_front(rows: Mapping[str, Row], others: Sequence[Against]) -> str:
    best = front(rows)
    different = [
        f"`{one.method}` {one.delay.difference:+.1f} s"
        for one in others
        if one.delay.difference is not None and one.delay_p is not None and one.delay_p < 0.05
    ]
    how = " (paired by condition and seed, Holm's correction)"
    if all(one.delay_p is None for one in others):
        told = "one run each is too little to test whether delays differ"
    elif different:
        told = f"beyond chance, these differ in delay from `{OURS}`: {', '.join(different)}{how}"
    else:
        told = f"no method's delay differs from that of `{OURS}` beyond chance{how}"
    listed = ", ".join(f"`{one}`" for one in best)
    references = " and ".join(f"`{one}`" for one in REFERENCES)
    return (
        f"**Safety against delay.** Among the methods of avoidance ({references} are references), no other "
        "method has both fewer preventable contacts per encounter and less delay than "
        f"{listed}; `{OURS}` is {'' if OURS in best else 'not '}among them; {told}."
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
