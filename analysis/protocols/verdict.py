"""Verdicts on tests: pure functions of the measurements and the protocol's requirements."""

from __future__ import annotations

from dataclasses import dataclass, replace

from analysis.protocols import colours
from analysis.protocols.impact import Measured

EMERGENCY_MPS2 = 5.0
"""Deceleration of emergency braking; to reach it without a reason is a false reaction [m/s^2]."""


@dataclass(frozen=True, slots=True)
class Demand:
    """The requirement of a protocol in one case.

    Parameters
    ----------
    rule : ``no_contact``; ``impact_speed`` at most ``highest_impact_kmh``; ``green``; ``not_red``;
        ``no_worse`` a colour than the standard case's; ``no_false_stop``; ``no_false_braking``
    ego_speed_kmh : test speed [km/h]
    highest_impact_kmh : limit of rule ``impact_speed`` [km/h]
    avoidance_only : whether every contact is red
    in_view : whether the pedestrian is in the ego's path long before the test, so that a contact is
        preventable
    """

    rule: str
    ego_speed_kmh: float
    highest_impact_kmh: float | None = None
    avoidance_only: bool = False
    in_view: bool = False

    @property
    def coloured(self) -> bool:
        """Whether the protocol gives colours."""
        return self.rule in ("green", "not_red", "no_worse")


@dataclass(frozen=True, slots=True)
class Verdict:
    """Result of one test."""

    passed: bool
    preventable: bool
    """Whether a competent and careful driver could have stopped; true if undefined."""
    contact: bool
    impact_speed_kmh: float | None
    """Relative impact speed along the ego; ``None`` without a contact [km/h]."""
    colour: str
    """Colour; empty if the protocol gives none."""
    points: float | None
    """Share of the case's points, 0 to 1; ``None`` if the protocol gives none."""
    max_deceleration_mps2: float
    note: str = ""
    """Why the test was not passed, and further remarks, in one line."""

    @property
    def counts(self) -> bool:
        """Whether the test is a failure that sets the exit code: not passed although preventable."""
        return not self.passed and self.preventable


def decide(measured: Measured, demand: Demand) -> Verdict:
    """Return the verdict on one test, regardless of others.

    Rule ``no_worse`` requires green here; `compared` compares it with the standard case.

    Notes
    -----
    Impact speeds follow [R152]_, contacts [FMVSS127]_, and colours [EuroNCAP2026]_. In the false-reaction
    tests, after [R152]_, the ego must neither stop nor touch anybody, nor brake with 5 m/s² or more for a
    pedestrian who is never on a collision course. A contact after a stop counts, too, although protocols end
    a test with the stop.
    """
    impact = measured.impact
    speed = None if impact is None else max(3.6 * impact.speed, 0.0)
    colour = ""
    if demand.coloured and _took_place(measured, demand):
        colour = colours.colour(demand.ego_speed_kmh, speed, demand.avoidance_only)
    reasons = [_failure(measured, demand, speed, colour)]
    if measured.after_stop:
        reasons.append("the contact came after the ego had stopped and gone on")
    if impact is not None and impact.side != "front":
        reasons.append(f"the ego's {impact.side} was hit")
    return Verdict(
        passed=not reasons[0],
        preventable=demand.in_view or measured.preventable is not False,
        contact=impact is not None,
        impact_speed_kmh=speed,
        colour=colour,
        points=colours.FACTORS[colour] if colour else 0.0 if demand.coloured else None,
        max_deceleration_mps2=measured.largest_deceleration,
        note="; ".join(reason for reason in reasons if reason),
    )


def compared(verdict: Verdict, standard: Verdict) -> Verdict:
    """Return the verdict of rule ``no_worse``, compared with the verdict on the standard case.

    Without a test in either case, there is nothing to compare.
    """
    if not (verdict.colour and standard.colour):
        return verdict
    passed = not colours.worse(verdict.colour, standard.colour)
    note = "" if passed else f"{verdict.colour}, in the standard case {standard.colour}"
    return replace(verdict, passed=passed, note=note)


def _failure(measured: Measured, demand: Demand, speed: float | None, colour: str) -> str:
    """Return why the test was not passed; empty if it was passed."""
    if not _took_place(measured, demand):
        return "no test: the ego did not come near enough for the pedestrian to set off"
    if demand.rule in ("no_false_stop", "no_false_braking"):
        return _false_reaction(measured, speed, demand.rule == "no_false_braking")
    if speed is None:
        return ""
    told = f"impact at {speed:.1f} km/h"
    if demand.rule == "no_contact":
        return told
    if demand.rule == "impact_speed":
        assert demand.highest_impact_kmh is not None
        highest = demand.highest_impact_kmh
        return "" if speed <= highest and highest > 0.0 else f"{told}, at most {highest:g} km/h allowed"
    if demand.rule == "not_red":
        return f"{told}, red" if colour == "red" else ""
    return f"{told}, {colour}"


def _took_place(measured: Measured, demand: Demand) -> bool:
    """Return whether the ego met the pedestrian; a controller that does not drive has passed nothing."""
    return measured.impact is not None or (measured.near and (measured.walked or demand.in_view))


def _false_reaction(measured: Measured, speed: float | None, braking_counts: bool) -> str:
    if speed is not None:
        return f"impact at {speed:.1f} km/h"
    if measured.stopped:
        return "it stopped for nobody"
    if braking_counts and measured.largest_deceleration >= EMERGENCY_MPS2:
        return f"it braked with {measured.largest_deceleration:.1f} m/s² for nobody"
    return ""
