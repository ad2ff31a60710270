"""The bars that the zoo has to meet: each bar, what was measured, and whether it is met."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from studies.zoo.results import Contact, Run
from studies.zoo.tally import Tally, of, shared

JUDGED = "vo_mpc"
REFERENCE, RIVAL = "sumo", "aeb"
SUDDEN = ("appeared", "touching_at_start")
"""Classes of contacts with people first seen inside the emergency stopping distance or touching the body."""
EXPLAINED = {"tight_bend": "bends too tight for a car", "off_lane": "places beside the lane that SUMO lacks"}
"""Causes of interventions that explain them."""
FORESEEABLE = "n_stopped_on_crossing_foreseeable"
LEAST_ENTERED, LEAST_NETWORKS, LEAST_ON_EACH = 2000, 15, 100


@dataclass(frozen=True, slots=True)
class Bar:
    """One bar and what was measured."""

    what: str
    measured: str
    met: bool | None
    """Whether the bar is met; ``None`` if nothing was measured for it."""

    @property
    def verdict(self) -> str:
        """Return the verdict in one word."""
        return {True: "met", False: "**missed**", None: "open"}[self.met]


def bars(runs: Sequence[Run], own_demand: Sequence[str]) -> list[Bar]:
    """Return all bars.

    Parameters
    ----------
    runs : Sequence
        Runs of all controllers.
    own_demand : Sequence
        Networks with a ready-made configuration, which need no least number of encounters.
    """
    judged = of(runs, JUDGED)
    contacts, entered = judged.contacts, judged.entered
    networks = sorted({run.network for run in judged.valid if run.number("n_entered")})
    few = sorted(
        name
        for name in {run.network for run in judged.runs} - set(own_demand)
        if of(runs, JUDGED, name).entered < LEAST_ON_EACH
    )
    lost = [run for run in runs if not run.valid and not run.of_sumo]
    teleported = [run for run in runs if run.of_sumo]
    sudden = [contact for contact in contacts if _sudden(contact)]
    rest = [contact.impact_kmh or 0.0 for contact in contacts if not _sudden(contact)]
    ran, met = bool(judged.valid), bool(entered or contacts)
    return [
        Bar(
            "every run finishes and is analysed and reported", f"{len(lost)} of {len(runs)} failed", not lost
        ),
        Bar(
            "at most 1 run in 50 with an ego that SUMO teleported",
            f"{len(teleported)} of {len(runs)}",
            50 * len(teleported) <= len(runs),
        ),
        Bar(
            f"at least {LEAST_ENTERED:,} entered encounters on at least {LEAST_NETWORKS} networks",
            f"{entered:,} on {len(networks)}",
            entered >= LEAST_ENTERED and len(networks) >= LEAST_NETWORKS,
        ),
        Bar(
            f"at least {LEAST_ON_EACH} entered encounters on each network with demand of the zoo",
            f"fewer on {len(few)}" + (f": {', '.join(few)}" if few else ""),
            not few,
        ),
        Bar(
            "0 preventable contacts",
            f"{judged.preventable} of {len(contacts)}",
            _zero(judged.preventable, met),
        ),
        _against_sumo(runs),
        _against_rival(runs),
        Bar(
            "impact speed at most 5 km/h, except with pedestrians who appeared suddenly",
            f"largest {max(rest):.1f} km/h" if rest else "no such contact",
            max(rest, default=0.0) <= 5.0 if met else None,
        ),
        Bar(
            "contacts with pedestrians who appeared suddenly: at most 1 in 200 entered encounters",
            f"{len(sudden)} in {entered:,}",
            200 * len(sudden) <= entered if met else None,
        ),
        _none("0 ego-closed overlaps with vehicles", judged.total("n_vehicle_overlaps_ego_closed"), ran),
        Bar(
            "0 stops on a crossing that it could have foreseen",
            f"{judged.total(FORESEEABLE)} of {judged.total('n_stopped_on_crossing')}",
            _zero(judged.total(FORESEEABLE), ran),
        ),
        Bar(
            "0 deadlocks",
            f"{judged.total('deadlock')}; {judged.total('n_egos_given_up')} egos were given up",
            _zero(judged.total("deadlock"), ran),
        ),
        _interventions(judged, ran),
        _none("0 passes within 0.5 m above 3 m/s", judged.total("n_close_passes"), ran),
        _delay(runs),
    ]


def _none(what: str, count: int, ran: bool) -> Bar:
    return Bar(what, str(count), _zero(count, ran))


def _zero(count: int, ran: bool) -> bool | None:
    return count == 0 if ran else None


def _sudden(contact: Contact) -> bool:
    return any(kind in contact.kind for kind in SUDDEN)


def _interventions(judged: Tally, ran: bool) -> Bar:
    explained = {cause: judged.total(f"n_interventions_{cause}") for cause in EXPLAINED}
    others = judged.total("n_interventions") - sum(explained.values())
    known = ", ".join(f"{count} in {EXPLAINED[cause]}" for cause, count in explained.items())
    return Bar("0 unexplained interventions", f"{others} besides {known}", _zero(others, ran))


def _against_sumo(runs: Sequence[Run]) -> Bar:
    mine, theirs = shared(runs, JUDGED, REFERENCE)
    count, other = len(mine.contacts), len(theirs.contacts)
    return Bar(
        "contacts at most a fifth of those of SUMO's driver, same runs",
        f"{count} against {other}",
        5 * count <= other if mine.entered or count else None,
    )


def _against_rival(runs: Sequence[Run]) -> Bar:
    mine, theirs = shared(runs, JUDGED, RIVAL)
    count, other = len(mine.contacts), len(theirs.contacts)
    return Bar(
        f"fewer contacts than {RIVAL}, same runs",
        f"{count} against {other}",
        (count < other or other == 0 == count) if mine.entered or count else None,
    )


def _delay(runs: Sequence[Run]) -> Bar:
    mine, theirs = (tally.delay_s for tally in shared(runs, JUDGED, REFERENCE))
    what = "mean delay at most 5 % above that of SUMO's driver, same runs"
    if mine is None or theirs is None:
        return Bar(what, "", None)
    return Bar(what, f"{mine:.1f} s against {theirs:.1f} s", mine <= 1.05 * theirs)
