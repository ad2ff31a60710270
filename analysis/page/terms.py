"""Terms that the page explains where they occur, and definitions of the measures that it shows."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from markupsafe import Markup, escape

from analysis.page.tables import label, measures_by_name
from analysis.results.measures import Measure
from analysis.results.metric_catalog import Metric, find_metrics

_OF_TALLY = {
    "met_collision": "collision",
    "met_ttc_lt_1p5": "time_to_collision",
    "met_pet_lt_1p5": "post_encroachment_time",
    "met_drac_gt_3p4": "deceleration_to_avoid_collision",
    "met_conflict": "severity",
}


@dataclass(frozen=True, slots=True)
class Term:
    """A technical term, and what it means here."""

    anchor: str
    """Anchor in the glossary of the documentation."""
    name: str
    text: str
    words: tuple[str, ...]


@cache
def terms() -> tuple[Term, ...]:
    """Return all terms, in the order of their file."""
    content = tomllib.loads((Path(__file__).parent / "terms.toml").read_text("utf-8"))
    return tuple(
        Term(anchor, one["name"], one["text"], tuple(one["words"])) for anchor, one in content.items()
    )


@cache
def _by_word() -> tuple[re.Pattern[str], Mapping[str, Term]]:
    known = {word: term for term in terms() for word in term.words}
    longest_first = sorted(known, key=len, reverse=True)
    return re.compile(r"\b(?:" + "|".join(map(re.escape, longest_first)) + r")\b"), known


def linked(text: str) -> Markup:
    """Return a text as HTML, with each term linked to its definition, which also shows on hovering.

    Examples
    --------
    >>> linked("no term & <b>")
    Markup('no term &amp; &lt;b&gt;')
    >>> 'href="#term-ttc"' in linked("TTC [s]")
    True
    """
    pattern, known = _by_word()
    parts: list[Markup] = []
    at = 0
    for found in pattern.finditer(text):
        term = known[found.group()]
        parts.append(escape(text[at : found.start()]))
        parts.append(
            Markup('<a class="term" href="#term-{}" title="{}: {}">{}</a>').format(
                term.anchor, term.name, term.text, found.group()
            )
        )
        at = found.end()
    return Markup("").join([*parts, escape(text[at:])])


def known_measures() -> set[str]:
    """Return the names of all measures that have a definition."""
    return {name for name, _ in measures_by_name()}


def definitions(shown: Iterable[str]) -> list[dict[str, Any]]:
    """Return the definitions of the measures that the page shows, in the order of their names.

    Parameters
    ----------
    shown
        Names of measures.
    """
    names = set(shown)
    by_name = {name: measure for (name, _), measure in measures_by_name().items() if name in names}
    found: list[dict[str, Any]] = []
    first: dict[str, str] = {}
    for name in sorted(by_name):
        one = _definition(by_name[name])
        same = first.setdefault(one["made"], name)
        found.append(one if same == name else one | {"made": f"Defined with {same}.", "source": ""})
    return found


def _definition(measure: Measure) -> dict[str, Any]:
    metric = _owner(measure)
    made = "" if metric is None else metric.text.partition("\n\n")[2] or metric.text
    return {
        "metric": measure.name,
        "text": label(measure),
        "ratio": _ratio(measure),
        "worse": measure.worse,
        "made": " ".join(made.split()),
        "source": "" if metric is None else metric.source,
    }


def _ratio(measure: Measure) -> str:
    """Return what is divided by what; empty for a measure that is no ratio."""
    if measure.kind == "yes_no":
        return "runs with at least one, over all valid runs"
    if measure.kind not in ("share", "rate"):
        return ""
    return f"sum of {measure.numerator} over that of {measure.denominator}, in {measure.denominator_unit}"


def _owner(measure: Measure) -> Metric | None:
    metrics = {one.name: one for one in find_metrics()}
    if measure.numerator in _OF_TALLY:
        return metrics[_OF_TALLY[measure.numerator]]
    of_encounters = measure.kind == "encounter"
    for one in metrics.values():
        columns = one.columns if of_encounters else one.run_columns
        if measure.numerator in {each.name for each in columns}:
            return one
    return None
