"""What is asked of a measured number, with the number beside it."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Bar:
    """One measured number and its bound; give exactly one of the two bounds."""

    what: str
    measured: float
    at_least: float | None = None
    at_most: float | None = None
    unit: str = "x"
    note: str = ""
    undecided: str = ""
    """Why the number says nothing, where it does not; the bar is then neither met nor missed."""

    @property
    def met(self) -> bool:
        """Whether the number is within its bound."""
        sign, bound = self._bound()
        return bool({"≥": operator.ge, "≤": operator.le}[sign](self.measured, bound))

    def entry(self) -> dict[str, Any]:
        """Return what is kept in the results.

        >>> Bar(what="speed", measured=9.04, at_least=8.0).entry()["verdict"]
        'met'
        >>> Bar(what="speed", measured=9.04, at_least=8.0, undecided="too few runs").entry()["verdict"]
        'too few runs'
        """
        sign, bound = self._bound()
        verdict = "met" if self.met else f"MISSED by {_short(abs(self.measured - bound))}"
        return {
            "what": self.what,
            "bar": f"{sign} {bound:g} {self.unit}".rstrip(),
            "measured": f"{_short(self.measured)} {self.unit}".rstrip(),
            "verdict": self.undecided or verdict,
            "note": self.note,
        }

    def _bound(self) -> tuple[str, float]:
        if self.at_least is not None:
            return "≥", self.at_least
        if self.at_most is None:
            raise ValueError(f"{self.what}: a bar needs a bound")
        return "≤", self.at_most


def show(bars: Sequence[Bar]) -> None:
    """Print bars, one a line."""
    for bar in bars:
        print(line(bar.entry()), flush=True)


def line(entry: Mapping[str, Any]) -> str:
    """Return one kept bar as a line."""
    note = f" ({entry['note']})" if entry["note"] else ""
    return f"bar: {entry['what']}: {entry['bar']}; measured {entry['measured']}{note}: {entry['verdict']}"


def _short(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"
