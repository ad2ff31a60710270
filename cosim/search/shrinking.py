"""Finds, for the clearest failure of each kind, the smallest change of parameters back to success."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from analysis.search.axes import Axis, Point, Value
from analysis.search.kinds import Kind
from analysis.search.results import PASS, Tried
from analysis.search.shrinking import Asking, Change, nearest, smallest_change
from cosim.search.trials import Answer, Trial, Trials

MOST = 4
"""Largest number of kinds whose boundary is searched, the clearest ones first."""


@dataclass(frozen=True, slots=True)
class Shrunk:
    """The smallest change found for a kind, and the number of runs made for it."""

    change: Change | None
    runs: int


@dataclass(slots=True)
class _Open:
    number: int
    seed: int
    asking: Asking
    wanted: list[dict[str, Value]]
    runs: int = 0


def changes(
    axes: Sequence[Axis],
    found: Sequence[Kind],
    tried: Sequence[Tried],
    trials: Trials,
    seedless: Callable[[Point], Point],
) -> dict[int, Shrunk]:
    """Return the smallest changes by the number of the kind, searching for all kinds at the same time.

    Parameters
    ----------
    axes
        Axes of the space, without that of the seed.
    found
        Kinds of failures.
    tried
        All runs of the search.
    trials
        Makes the runs.
    seedless
        Removes the seed from a point.
    """
    done: dict[int, Shrunk] = {}
    waiting: list[_Open] = []
    for number, kind in enumerate(found[:MOST], 1):
        worst = kind.worst
        passing = [seedless(one.point) for one in tried if one.status == PASS and one.seed == worst.seed]
        failing = seedless(worst.point)
        near = nearest(axes, failing, passing)
        if near is None:
            continue
        asking = smallest_change(axes, failing, near)
        try:
            waiting.append(_Open(number, worst.seed, asking, next(asking)))
        except StopIteration:
            continue
    while waiting:
        asked = [(one, point) for one in waiting for point in one.wanted]
        trials.tally.total += len(asked)
        answers = trials.run([_trial(one, i) for i, one in _numbered(asked)])
        by_kind: dict[int, list[bool]] = {}
        for (one, _), answer in zip(asked, answers, strict=True):
            by_kind.setdefault(one.number, []).append(_passes(answer))
            one.runs += 1
        waiting = [one for one in waiting if _goes_on(one, by_kind[one.number], done)]
    return done


def _numbered(
    asked: Sequence[tuple[_Open, dict[str, Value]]],
) -> list[tuple[int, tuple[_Open, dict[str, Value]]]]:
    """Give each point a number that is unique within its kind."""
    counts: dict[int, int] = {}
    numbered = []
    for one, point in asked:
        counts[one.number] = counts.get(one.number, one.runs) + 1
        numbered.append((counts[one.number], (one, point)))
    return numbered


def _trial(asked: tuple[_Open, dict[str, Value]], number: int) -> Trial:
    one, point = asked
    name = f"change-{one.number:02d}-{number:03d}"
    return Trial(name, point, one.seed, f"Run {number} of the search for what makes kind {one.number} pass")


def _passes(answer: Answer) -> bool:
    verdict = answer.verdict
    return (
        not answer.invalid and verdict.margin is not None and not verdict.failed and not verdict.unpreventable
    )


def _goes_on(one: _Open, answers: list[bool], done: dict[int, Shrunk]) -> bool:
    try:
        one.wanted = one.asking.send(answers)
    except StopIteration as stop:
        done[one.number] = Shrunk(stop.value, one.runs)
        return False
    return True
