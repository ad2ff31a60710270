"""The objective of a search: the smallest margin of the criteria by which ``cosim check`` judges a run.

All margins have the same scale, m / (1 + |m|), where m is the distance to the threshold in units of `SCALES`.
So a margin lies between −1 and 1 and is negative if the criterion is violated.

If a criterion counts contacts, or contacts of a kind, its margin comes from continuous quantities:

- without a contact, the smaller one of the clearance of the moving ego and the time to collision;
- with a contact, the negative impact speed;
- with a contact that the careful driver of UN R157 would not have prevented, how much longer that driver
  would have had to see the risk, positive: it is not a failure, and the search is led away from it;
- a contact that it does not count, of another kind or of an encounter that it does not choose, has no margin.

A criterion for another count or yes/no value has the margin 1 while it is met: a search can find its
violation, but has no slope to follow.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from analysis.criteria.criterion import Cells, Criterion, chosen_rows, judge, row_value
from analysis.metrics.contact_kind import COUNTED
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.thresholds import Thresholds

CONTACTS = frozenset(("collision", "n_collisions", "n_collisions_preventable", *COUNTED))
"""Metrics whose value 0 means that there was no contact, or none of a kind."""
SCALES: Mapping[str, float] = {"m": 2.0, "s": 1.5, "km/h": 10.0, "m/s": 3.0, "m/s^2": 3.0, "m/s^3": 10.0}
"""Distance to a threshold that counts as half of the scale, by unit; 1 for other units."""
LEAST = 0.01
"""Least size of the margin of a violated criterion, however little it is violated."""
NOT_PREVENTABLE = "0"
"""Text of `preventable_r157` for a contact that does not count."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """A run judged by the criteria."""

    margin: float | None
    """Smallest margin, −1 to 1, negative for a failure that counts; ``None`` with nothing to judge."""
    criterion: str = ""
    """Criterion with that margin."""
    facts: Mapping[str, str] = field(default_factory=dict)
    """Row of the encounter or run from which the margin comes."""
    unpreventable: bool = False
    """Whether there was a violation that the careful driver would not have prevented."""
    judged: frozenset[str] = frozenset()
    """Criteria that had something to judge."""

    @property
    def failed(self) -> bool:
        """Whether it is a failure that counts."""
        return self.margin is not None and self.margin < 0.0


@dataclass(frozen=True, slots=True)
class _Margin:
    value: float
    facts: Cells
    unpreventable: bool = False


def searchable(criteria: Sequence[Criterion]) -> tuple[Criterion, ...]:
    """Return the criteria that a single run can violate."""
    return tuple(one for one in criteria if one.scope != "configuration")


def judge_run(criteria: Sequence[Criterion], encounters: Sequence[Cells], runs: Sequence[Cells]) -> Verdict:
    """Return the smallest margin of a run.

    Parameters
    ----------
    criteria
        Criteria of the scopes encounter and run.
    encounters, runs
        Rows of the run's encounters.csv and runs.csv.
    """
    best: tuple[_Margin, str] | None = None
    unpreventable, judged = False, set()
    for one in criteria:
        margins = [*_margins(one, encounters, runs)]
        for margin in margins:
            judged.add(one.id)
            unpreventable |= margin.unpreventable
            if best is None or margin.value < best[0].value:
                best = margin, one.id
    if best is None:
        return Verdict(None)
    return Verdict(best[0].value, best[1], best[0].facts, unpreventable, frozenset(judged))


def _margins(criterion: Criterion, encounters: Sequence[Cells], runs: Sequence[Cells]) -> Iterator[_Margin]:
    if criterion.metric in CONTACTS and criterion.operator in ("==", "<=", "<") and criterion.threshold < 1.0:
        yield from _of_contacts(criterion, encounters, runs)
    else:
        yield from _of_numbers(criterion, encounters, runs)


def _of_contacts(
    criterion: Criterion, encounters: Sequence[Cells], runs: Sequence[Cells]
) -> Iterator[_Margin]:
    of_run = criterion.scope == "run"
    if of_run and not chosen_rows(criterion, runs):
        return
    counted = [row for row in encounters if _is_about(criterion, row)]
    yield from map(_of_contact, counted)
    if of_run and all(row["collision"] != "1" for row in counted):
        # An encounter has the kind of its first contact only; the run's count includes every contact.
        yield from _of_numbers(criterion, encounters, runs)


def _is_about(criterion: Criterion, row: Cells) -> bool:
    """Return whether a criterion counts the contact of an encounter or, without a contact, might count one.

    The margin takes into account whether it was preventable.
    """
    wanted = dict(criterion.where) if criterion.scope == "encounter" else {}
    wanted.pop("preventable_r157", None)
    if criterion.metric in COUNTED:
        told_by, text = COUNTED[criterion.metric]
        wanted[told_by] = text
    if row["collision"] != "1":
        wanted = {column: value for column, value in wanted.items() if row[column]}
    return bool(chosen_rows(replace(criterion, where=wanted), [row]))


def _of_numbers(
    criterion: Criterion, encounters: Sequence[Cells], runs: Sequence[Cells]
) -> Iterator[_Margin]:
    table = ENCOUNTERS if criterion.scope == "encounter" else RUNS
    (column,) = [one for one in table.columns if one.name == criterion.metric]
    rows = chosen_rows(criterion, encounters if table is ENCOUNTERS else runs)
    counted = column.kind in ("integer", "boolean")
    for row in rows:
        found = judge(criterion, row_value(criterion, row))
        if found.margin is None:
            continue
        value = squashed(found.margin / SCALES.get(criterion.unit, 1.0))
        if found.status == "pass":
            yield _Margin(1.0 if counted else max(value, 0.0), row)
        elif table is ENCOUNTERS and row["preventable_r157"] == NOT_PREVENTABLE:
            yield _Margin(LEAST, row, unpreventable=True)
        else:
            yield _Margin(min(value, -LEAST), row)


def judge_contacts(encounters: Sequence[Cells], preventable_only: bool) -> float:
    """Return the margin of a run to a contact; 1 without any encounter.

    Parameters
    ----------
    encounters
        Rows of the run's encounters.csv.
    preventable_only
        Whether a contact counts only if the careful driver would have prevented it.
    """
    counted = encounters
    if not preventable_only:
        counted = [{**row, "preventable_r157": ""} for row in encounters]
    return min((_of_contact(row).value for row in counted), default=1.0)


def squashed(value: float) -> float:
    """Return a number mapped to the range from −1 to 1, with 0 unchanged.

    Examples
    --------
    >>> squashed(1.0), squashed(-3.0)
    (0.5, -0.75)
    """
    return value / (1.0 + abs(value))


def _of_contact(row: Cells) -> _Margin:
    if row["collision"] == "1":
        if row["preventable_r157"] == NOT_PREVENTABLE:
            return _Margin(max(LEAST, squashed(_missing_s(row))), row, unpreventable=True)
        speed = _number(row, "impact_speed_kmh") or 0.0
        return _Margin(min(-LEAST, squashed(-speed / SCALES["km/h"])), row)
    near = [
        squashed(value / SCALES[unit])
        for name, unit in (("clearance_min_m", "m"), ("min_ttc_s", "s"))
        if (value := _number(row, name)) is not None
    ]
    return _Margin(min(near, default=1.0), row)


def _missing_s(row: Cells) -> float:
    """Return how much longer the careful driver would have had to see the risk to stop by braking [s]."""
    limits = Thresholds()
    speed = _number(row, "max_speed_mps") or 0.0
    seen = _number(row, "contact_risk_seen_s") or 0.0
    braking = speed / (2.0 * limits.r157_deceleration_mps2)
    return max(0.0, limits.r157_reaction_s + 0.5 * limits.r157_ramp_s + braking - seen)


def _number(row: Cells, name: str) -> float | None:
    return float(row[name]) if row.get(name) else None
