"""Criteria: a number of a table, an operator and a threshold. Pure evaluation; nothing is read or run.

A criterion of scope *encounter* or *run* judges every row of encounters.csv or runs.csv; one of scope
*configuration* judges a statistic of configs.csv. An undefined value does not pass: its status is
``undefined``, which fails unless the criterion sets ``allow_undefined``.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from analysis.statistics.intervals import rate_lower_bound, share_lower_bound

Cells = Mapping[str, str]
"""A row of a CSV file."""

OPERATORS: Mapping[str, Callable[[float, float], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
}
SCOPES = ("encounter", "run", "configuration")

_EVENTS = ("count", "yes_no", "share", "rate")
_ALL = ("mean", *_EVENTS, "encounter")
STATISTICS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    **{name: (name, _ALL) for name in ("mean", "sd", "min", "p05", "median", "p95", "max")},
    **{name: (name, _ALL) for name in ("ci95_lo", "ci95_hi")},
    "share": ("mean", ("share", "yes_no")),
    "rate": ("mean", ("rate",)),
    "total": ("numerator", _EVENTS),
    "upper_95": ("upper95", _EVENTS),
    "lower_95": ("", _EVENTS),
    **{name: (name, _EVENTS) for name in ("exact95_lo", "exact95_hi")},
    **{name: (name, ("encounter",)) for name in ("tail95_lo", "tail95_hi")},
}
"""Statistic -> its column in configs.csv, and the kinds of measures that have it."""


@dataclass(frozen=True, slots=True)
class Criterion:
    """A limit that a number is compared with."""

    id: str
    scope: str
    metric: str
    operator: str
    threshold: float
    unit: str = "1"
    statistic: str = ""
    """Statistic that is judged; only of scope *configuration*."""
    kind: str = ""
    """Kind of the measure, as in column ``kind`` of configs.csv; only of scope *configuration*."""
    where: Mapping[str, bool | float | str] = field(default_factory=dict)
    """Column -> value; only rows with these values are judged."""
    controllers: tuple[str, ...] = ()
    """Controllers whose runs are judged; empty: all."""
    scenarios: tuple[str, ...] = ()
    """Scenarios whose runs are judged; empty: all."""
    allow_undefined: bool = False

    def applies_to(self, scenario: str, controller: str) -> bool:
        """Return whether runs of this scenario and controller are judged."""
        return (not self.scenarios or scenario in self.scenarios) and (
            not self.controllers or controller in self.controllers
        )


@dataclass(frozen=True, slots=True)
class Judgement:
    """Result of comparing a value with a threshold."""

    status: str
    """``pass``, ``fail`` or ``undefined``."""
    value: float | None
    margin: float | None
    """Distance to the threshold, positive on the side that passes."""


def judge(criterion: Criterion, value: float | None) -> Judgement:
    """Judge a value by a criterion.

    Examples
    --------
    >>> judge(Criterion("gap", "run", "min_dist_m", ">=", 0.5), 0.75)
    Judgement(status='pass', value=0.75, margin=0.25)
    """
    if value is None:
        return Judgement("undefined", None, None)
    good = OPERATORS[criterion.operator](value, criterion.threshold)
    return Judgement(
        "pass" if good else "fail", value, margin(criterion.operator, criterion.threshold, value)
    )


def margin(sign: str, threshold: float, value: float) -> float:
    """Return the distance of a value from the threshold, positive on the side that passes.

    Examples
    --------
    >>> margin("<=", 9.0, 7.5), margin("==", 0.0, 2.0)
    (1.5, -2.0)
    """
    if sign == "==":
        return -abs(value - threshold)
    return threshold - value if sign.startswith("<") else value - threshold


def chosen_rows(criterion: Criterion, rows: Iterable[Cells]) -> list[Cells]:
    """Return the rows that a criterion of encounters or runs judges; an empty cell equals no number."""
    return [
        row for row in rows if all(_equal(row[column], wanted) for column, wanted in criterion.where.items())
    ]


def _equal(cell: str, wanted: bool | float | str) -> bool:
    if isinstance(wanted, str):
        return cell == wanted
    return cell != "" and float(cell) == float(wanted)


def row_value(criterion: Criterion, row: Cells) -> float | None:
    """Return the value of a row of encounters.csv or runs.csv; ``None`` if it is undefined."""
    cell = row[criterion.metric]
    return float(cell) if cell else None


def statistic_value(criterion: Criterion, row: Cells) -> float | None:
    """Return the statistic of a row of configs.csv; ``None`` if there is none.

    Raises
    ------
    ValueError
        For a row of another measure.
    """
    if (row["metric"], row["kind"]) != (criterion.metric, criterion.kind):
        raise ValueError(f"expected a row of {criterion.metric} ({criterion.kind}), got {row['metric']}")
    column, _ = STATISTICS[criterion.statistic]
    if column:
        return float(row[column]) if row[column] else None
    if not row["numerator"] or not row["denominator"]:
        return None
    events, exposure = round(float(row["numerator"])), float(row["denominator"])
    if criterion.kind in ("share", "yes_no"):
        return share_lower_bound(events, round(exposure))
    return rate_lower_bound(events, exposure)
