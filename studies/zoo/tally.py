"""Sums over several runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from analysis.statistics.intervals import share_interval
from studies.zoo.results import Contact, Run


@dataclass(frozen=True, slots=True)
class Tally:
    """The results of several runs, summed up."""

    runs: Sequence[Run]

    @property
    def valid(self) -> list[Run]:
        """Return the runs that reached their end without a fault; all numbers below cover these."""
        return [run for run in self.runs if run.valid]

    @property
    def contacts(self) -> list[Contact]:
        """Return the contacts with a moving ego."""
        return [contact for run in self.valid for contact in run.contacts]

    @property
    def preventable(self) -> int:
        """Return how many contacts the careful driver would have avoided."""
        return sum(contact.preventable for contact in self.contacts)

    @property
    def classes(self) -> Counter[str]:
        """Return the number of contacts of each class; empty if the analysis does not say."""
        return Counter(contact.kind for contact in self.contacts if contact.kind)

    @property
    def entered(self) -> int:
        """Return the number of entered encounters."""
        return self.total("n_entered")

    @property
    def largest_impact_kmh(self) -> float | None:
        """Return the largest speed at which an ego touched somebody [km/h]."""
        return max((contact.impact_kmh or 0.0 for contact in self.contacts), default=None)

    @property
    def delay_s(self) -> float | None:
        """Return the mean delay of an ego relative to free flow, ``ego_time_loss_s`` per ego [s]."""
        egos = self.total("ego_count")
        return sum(run.number("ego_time_loss_s") for run in self.valid) / egos if egos else None

    @property
    def share(self) -> str:
        """Return the exact 95 % interval of the contacts per entered encounter [%]."""
        touched = len(self.contacts)
        found = share_interval(touched, max(self.entered, touched))
        return f"{100 * found.low:.1f} to {100 * found.high:.1f} %" if found is not None else ""

    def total(self, column: str) -> int:
        """Return the sum of a column of counts of ``runs.csv``."""
        return int(sum(run.number(column) for run in self.valid))


def of(runs: Iterable[Run], controller: str, network: str | None = None) -> Tally:
    """Return the tally of a controller, on one network or on all."""
    return Tally(
        [run for run in runs if run.controller == controller and network in (None, run.network)],
    )


def shared(runs: Sequence[Run], one: str, other: str) -> tuple[Tally, Tally]:
    """Return the tallies of two controllers over the networks and seeds with valid runs of both."""
    places = [{(run.network, run.seed) for run in of(runs, name).valid} for name in (one, other)]
    both = places[0] & places[1]
    kept = [run for run in runs if (run.network, run.seed) in both]
    return of(kept, one), of(kept, other)
