"""Puts the comparison of two controllers into words: a sentence, a table, and notes on how to read it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table

from analysis.results.measures import DELAY, Measure
from analysis.statistics.intervals import share_upper_bound
from analysis.study.comparison_rows import Pairs
from analysis.study.runs import StudyRun
from analysis.study.seeds_needed import MEANING, NOT_SHOWN, range_needed, seeds_needed
from analysis.wording import decimals, p_value

Row = Mapping[str, Any]

_WORDS = {NOT_SHOWN: "no difference shown"}
_SHARES = ("share", "yes_no")


def sentence(rows: Sequence[Row], measures: Mapping[str, Measure]) -> str:
    """Return the answer: is the alternative safer than the base, and slower?"""
    first = rows[0]
    where = first["scenario_id"] + (f" ({first['condition']})" if first["condition"] else "")
    pairs = max(row["n_pairs"] for row in rows)
    answers = [
        text
        for text in (
            _safety([row for row in rows if row["group"] == "safety"], measures),
            _delay([row for row in rows if row["metric"] == DELAY]),
        )
        if text
    ]
    if not answers:
        shown = sum(row["verdict"] != NOT_SHOWN for row in rows)
        answers = [f"a difference in {shown} of {len(rows)} measures"]
    on = f"{pairs} seed" + ("s" if pairs != 1 else "")
    return f"{first['alt']} against {first['base']} on {where}, {on}: {', and '.join(answers)}."


def _safety(rows: Sequence[Row], measures: Mapping[str, Measure]) -> str:
    if not rows:
        return ""
    better, worse = (
        ", ".join(measures[row["metric"]].text for row in rows if row["verdict"] == verdict)
        for verdict in ("better", "worse")
    )
    if better and worse:
        return f"neither safer nor less safe (better: {better}; worse: {worse})"
    if better:
        return f"safer ({better})"
    return f"less safe ({worse})" if worse else "no difference in safety shown" + range_needed(rows)


def _delay(rows: Sequence[Row]) -> str:
    if not rows:
        return ""
    row = rows[0]
    word = {"worse": "slower", "better": "faster"}.get(row["verdict"])
    next_step = "" if word else range_needed(rows)
    word = word or "no difference in delay shown"
    if row["ci95_lo"] is None:
        return word + next_step
    ends = f"{row['ci95_lo']:+.1f} … {row['ci95_hi']:+.1f}"
    interval = f"95 % {ends}"
    if row["n_family"] > 1:
        # The interval does not account for the other tests, but the verdict does.
        p = p_value(row["p_holm"])
        interval = f"95 % alone {ends}; p {p}, corrected for {row['n_family']} tests"
    return f"{word} ({row['diff_mean']:+.1f} s, {interval}){next_step}"


def table(rows: Sequence[Row], measures: Mapping[str, Measure]) -> Table:
    """Return one line per measure."""
    found = Table(box=None, pad_edge=False, header_style="bold")
    found.add_column("")
    for name in (rows[0]["base"], rows[0]["alt"], "difference", "95 % alone", "p (Holm)", "seeds / needed"):
        found.add_column(name, justify="right")
    found.add_column("verdict")
    for row in rows:
        measure = measures[row["metric"]]
        found.add_row(
            _label(measure),
            _value(row["base_mean"], measure),
            _value(row["alt_mean"], measure),
            _value(row["diff_mean"], measure, "+"),
            _interval(row, measure),
            p_value(row["p_holm"]),
            " / ".join(filter(None, (str(row["n_pairs"]), seeds_needed(row)))),
            _WORDS.get(row["verdict"], row["verdict"]),
        )
    return found


def notes(rows: Sequence[Row], pairs: Pairs, runs: Sequence[StudyRun]) -> list[str]:
    """Return notes that help to read the table."""
    first = rows[0]
    said = [
        "Mean differences, paired by seed, those of shares in percentage points. The 95 % interval is that "
        "of one measure alone; the verdict follows from p, which is Holm-corrected over the "
        f"{first['n_family']} test{'s' * (first['n_family'] != 1)} of this table. "
        f'"No difference shown" does not mean that there is no difference. {MEANING}'
    ]
    for name, side in ((first["base"], pairs.base), (first["alt"], pairs.alt)):
        hit, met = (
            sum(run.numbers[key] for seed in side for run in seed) for key in ("met_collision", "met")
        )
        bound = share_upper_bound(round(hit), round(met))
        if bound is not None:
            said.append(
                f"{name}: {hit:.0f} collisions in {met:.0f} entered encounters, at most "
                f"{bound:.{decimals(100.0 * bound, 2)}%} of them "
                "(one-sided 95 %, assuming independent encounters)."
            )
        said.extend(_contacts(str(name), [run for seed in side for run in seed]))
    lost = [
        f"{number} {reason}"
        for number, reason in (
            (pairs.unpaired, "without a run of each under every condition"),
            (pairs.invalid, "with an invalid or unfinished run"),
        )
        if number
    ]
    if lost:
        said.append(f"Seeds left out: {', '.join(lost)}.")
    if len({run.versions for run in runs}) > 1:
        said.append("The runs were made by different versions; run.json says which.")
    return said


def _contacts(name: str, runs: Sequence[StudyRun]) -> list[str]:
    """Return a sentence on the kinds of contacts; empty if there were none."""
    total, spared, crossing, carriageway, beside, appeared = (
        sum(run.numbers.get(f"n_collisions{kind}", 0.0) for run in runs)
        for kind in (
            "",
            "_preventable",
            "_crossing",
            "_carriageway",
            "_walking_area_or_kerb",
            "_class_appeared",
        )
    )
    if total == 0.0:
        return []
    return [
        f"{name}: {spared:.0f} of the {total:.0f} contacts are preventable; {crossing:.0f} on a "
        f"crossing, {carriageway:.0f} on the carriageway, {beside:.0f} on a walking area or at the kerb; in "
        f"{appeared:.0f} the pedestrian appeared inside the stopping distance."
    ]


def _label(measure: Measure) -> str:
    """Return the label of a line; shares are in percent, and rates name their reference."""
    if measure.kind != "mean" or measure.unit == "1":
        return measure.text
    return f"{measure.text} [{measure.unit.replace('^2', '²').replace('^3', '³')}]"


def _value(value: float | None, measure: Measure, sign: str = "") -> str:
    if value is None:
        return "–"
    sign = sign if value else ""
    if measure.kind in _SHARES:
        return f"{value:{sign}.{decimals(100.0 * value, 1)}%}"
    return f"{value:{sign}.{decimals(value)}f}"


def _interval(row: Row, measure: Measure) -> str:
    if row["ci95_lo"] is None:
        return "–"
    return f"{_value(row['ci95_lo'], measure, '+')} … {_value(row['ci95_hi'], measure, '+')}"
