"""Experiments of the drivable-area paper: four situations, planned and driven, compared with braking."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from controllers.drivable_area.costs import CostWeights, SpeedRisk, speed_risk
from controllers.drivable_area.drivable_entropy import EntropyAt, EntropyMode
from controllers.drivable_area.evaluation import Verdict
from controllers.drivable_area.pareto_search import Front
from studies.papers.claim import Claim, Kind, compared, observed
from studies.papers.drivable_area import figures as drawings
from studies.papers.drivable_area.rides import ride_claims, rides_in
from studies.papers.drivable_area.scenes import (
    FRICTION,
    GRIP,
    NUMBER,
    PACE,
    SITUATIONS,
    START,
    WALKER,
    Situation,
    at_the_table,
    chosen,
    nearest,
    possible,
)
from studies.papers.drivable_area.several import chosen_among_several, draw_several, several_claims

PAPER = NUMBER
TITLE = "Drivable area, entropy and NSGA-II, against emergency braking"

BRAKE = f"friction {FRICTION:g}, dead time 0.1 s and ramp 0.2 s, which are not given"
UNPUBLISHED = "the pedestrian's start, the places, φ, the mass and the seeds are not published"
STARTS = np.arange(-0.5, 4.01, 0.5)
"""Possible starts of the pedestrian, measured from the right edge [m]."""
OTHER_WALKER = 1.0
"""A start of the pedestrian that leaves more room [m]."""
EXACT = 0.1
"""Relative tolerance of costs."""


def run(figures: Path, situations: Sequence[Situation] = SITUATIONS) -> list[Claim]:
    """Run all experiments, draw the figures and return the claims with their results.

    Parameters
    ----------
    figures : folder for the figures
    situations : at least two of them to search, to drive and to draw
    """
    rides = {one: rides_in(one) for one in situations}
    found = {one: chosen(one, EntropyMode.SHANNON) for one in situations}
    printed = {one: chosen(one, EntropyMode.PAPER) for one in situations}
    table = {one: at_the_table(one) for one in SITUATIONS}
    claims = [*_braking_claims(), *_text_claims(), *_count_claims()]
    for one in SITUATIONS:
        claims += _cost_claims(one, table[one])
    claims += [*_sum_claims(), *_distance_claims()]
    for one in situations:
        claims += _choice_claims(one, found[one], printed[one])
        claims.append(_physics_claim(one, table[one]))
    for one in situations:
        claims += ride_claims(one, rides[one])
    several = {one: chosen_among_several(one) for one in situations}
    claims += several_claims(several)
    draw_several(figures / f"{PAPER}-several-pedestrians.png", several)
    drawings.draw_candidates(figures / f"{PAPER}-candidates.png", found)
    drawings.draw_speeds(figures / f"{PAPER}-speed-profiles.png", found)
    drawings.draw_curvatures(figures / f"{PAPER}-curvature.png", found)
    drawings.draw_fronts(figures / f"{PAPER}-pareto-front.png", found)
    drawings.draw_rides(
        figures / f"{PAPER}-rides.png",
        {one: (ridden.brake, ridden.loose, ridden.strict) for one, ridden in rides.items()},
    )
    return claims


def _braking_claims() -> list[Claim]:
    """Return the claims about AEB that brakes at once."""
    return [
        observed(
            PAPER,
            f"{one.name}, AEB",
            "AEB stops before the pedestrian." if np.isfinite(one.brake.distance) else "AEB collides.",
            holds=(one.gap > 0.0) == bool(np.isfinite(one.brake.distance)),
            theirs=f"cost_d {one.brake.distance:g}",
            ours=f"stops after {one.braking.distance:.2f} m, {one.gap:.2f} m before",
            unit="m",
            test="sign of the gap",
            fitted=BRAKE,
            why="A3 depends on 8 cm" if one.name == "A3" else "",
        )
        for one in SITUATIONS
    ]


def _text_claims() -> list[Claim]:
    """Return the claims of the text about the distances, compared with the set-up and Table 2."""
    first, second, third, fourth = SITUATIONS
    unlike = "set-up, section 5.2 and Table 2 fit 20 m for A1 and A2; this paragraph says the opposite"

    def said(experiment: str, claim: str, holds: bool, ours: str, test: str) -> Claim:
        return observed(PAPER, experiment, claim, holds=holds, ours=ours, test=test, why=unlike)

    return [
        said(
            "A1, text",
            "The distance is about the shortest braking distance.",
            abs(first.gap) < 1.0,
            f"{first.gap:.2f} m are left",
            "gap below 1 m",
        ),
        said(
            "A2, text",
            "The distance is shorter than the braking distance; AEB fails.",
            second.gap < 0.0,
            f"{second.gap:.2f} m are left",
            "gap below 0",
        ),
        said(
            "A3 and A4, text",
            "The distances are within the safe braking distance.",
            min(third.gap, fourth.gap) > 0.0,
            f"{third.gap:.2f} and {fourth.gap:.2f} m are left",
            "gaps above 0",
        ),
        observed(
            PAPER,
            "A1, text",
            "The safety cost is better than that of AEB.",
            kind=Kind.ARITHMETIC,
            holds=first.found.distance < first.brake.distance,
            theirs="better",
            ours=f"{first.found.distance:g} against {first.brake.distance:g} in Table 2",
            test="cost_d smaller",
            why="text and table contradict each other",
        ),
    ]


def _count_claims() -> list[Claim]:
    """Return the claims about how many of the grid's candidates are feasible."""
    experiment = "12 · 14 candidates"
    counts = [possible(one, WALKER, -1.0) for one in SITUATIONS]
    limited = [possible(one, WALKER, -1.0, within_friction=True) for one in SITUATIONS]
    elsewhere = [possible(one, OTHER_WALKER, -1.0, within_friction=True) for one in SITUATIONS]
    ordered = strictly = 0
    for start in STARTS:
        for way in (1.0, -1.0):
            falling = np.diff([possible(one, float(start), way) for one in SITUATIONS])
            ordered += bool((falling <= 0).all())
            strictly += bool((falling < 0).all())
    total = 2 * len(STARTS)
    return [
        observed(
            PAPER,
            experiment,
            "Many candidates in A1 and A2, some in A3, few in A4.",
            holds=counts[0] > counts[1] > counts[2] > counts[3] > 0,
            theirs="many, many, some, few",
            ours=" / ".join(map(str, counts)),
            test="strictly falling, above 0",
            fitted=START,
            why="without a limit of lateral acceleration; offsets 0 to 3.5 m, speeds 0 to v0",
        ),
        observed(
            PAPER,
            experiment,
            "That order holds wherever the pedestrian starts.",
            kind=Kind.OWN,
            holds=ordered == total,
            ours=f"in {ordered} of {total} starts, strictly in {strictly}",
            test="in all",
            why=f"starts every 0.5 m from {STARTS[0]:g} to {STARTS[-1]:g} m, both directions",
        ),
        observed(
            PAPER,
            experiment,
            f"Candidates are left where the tyres hold {FRICTION:g} g.",
            kind=Kind.OWN,
            holds=min(limited) > 0,
            ours=" / ".join(map(str, limited)),
            test="above 0 in all",
            why="braking and turning together; "
            f"with a start at {OTHER_WALKER:g} m {' / '.join(map(str, elsewhere))} are left",
        ),
    ]


def _cost_claims(one: Situation, verdict: Verdict) -> list[Claim]:
    """Return the claims about the costs of the paper's candidate."""
    row, costs = one.found, verdict.costs[0]
    met = float(at_the_table(one, when=EntropyAt.MEETING).costs[0, 2])
    experiment = f"{one.name}, candidate of Table 2"
    return [
        compared(
            PAPER,
            experiment,
            "cost_c",
            theirs=row.curvature,
            ours=float(costs[0]),
            tolerance=round(EXACT * row.curvature, 4),
            fitted="k_max = 0.1/m, which is not given, and the first offset, that of AEB",
        ),
        compared(
            PAPER,
            experiment,
            "cost_d",
            theirs=row.distance,
            ours=float(costs[1]),
            tolerance=round(EXACT * row.distance, 4),
            why=f"v_s in m/s; {UNPUBLISHED}",
        ),
        compared(
            PAPER,
            experiment,
            "cost_s",
            theirs=row.entropy,
            ours=float(costs[2]),
            tolerance=round(EXACT * row.entropy, 4),
            why=f"mode paper, largest of all instants; at t_tcz of Eq. (30) it is {met:.3f}; {UNPUBLISHED}",
        ),
    ]


def _sum_claims() -> list[Claim]:
    """Return the claims about the sums of the table's own numbers, and about AEB's costs."""
    weights = CostWeights()
    claims = []
    for one in SITUATIONS:
        own, other = (
            float(weights.total(np.array([[row.curvature, row.distance, row.entropy, 0.0]]))[0])
            for row in (one.found, one.brake)
        )
        claims.append(
            observed(
                PAPER,
                f"{one.name}, Table 2",
                "By its weighted cost the method is better than AEB.",
                kind=Kind.ARITHMETIC,
                holds=own < other,
                theirs="better",
                ours=f"{own:.3f} against {other:.3f}",
                test="sum of Eq. (48) smaller",
                why="" if own < other else "with the table's own costs and weights, braking costs less",
            )
        )
    standing = float(speed_risk(np.zeros(1), SpeedRisk.METRES_PER_SECOND)[0])
    claims.append(
        compared(
            PAPER,
            "A1 and A2, AEB",
            "cost_d of AEB, which stops.",
            kind=Kind.ARITHMETIC,
            theirs=0.045,
            ours=standing,
            tolerance=0.0045,
            why="its safety coefficient C_vs is 0 at v_s = 0 in every reading",
        )
    )
    return claims


def _distance_claims() -> list[Claim]:
    """Return the claims on whether one pedestrian explains the column cost_d, for each reading of C_vs."""
    starts = np.linspace(-3.0, 8.0, 551)
    reached = {way: np.array([nearest(one, starts, way) for one in SITUATIONS]) for way in (1.0, -1.0)}
    claims = []
    for form in SpeedRisk:
        implied = np.array(
            [
                float(speed_risk(np.array([one.found.speed_kmh / 3.6]), form)[0]) / one.found.distance + 1.95
                for one in SITUATIONS
            ]
        )
        scatter = float(((implied - implied.mean()) ** 2).sum())
        fits = {
            way: 1.0 - ((implied[:, None] - got) ** 2).sum(axis=0) / scatter for way, got in reached.items()
        }
        way = max(fits, key=lambda one: float(fits[one].max()))
        best = int(fits[way].argmax())
        start = float(starts[best])
        unhindered = [float(nearest(one, np.array([start]), way, reacts=False)[0]) for one in SITUATIONS]
        claims.append(
            observed(
                PAPER,
                f"cost_d, v_s as {form.value}",
                "The distances that cost_d implies are those to one pedestrian.",
                kind=Kind.ARITHMETIC,
                holds=bool(fits[way][best] > 0.9),
                theirs=" / ".join(f"{value:.2f}" for value in implied) + " m",
                ours=f"R² = {fits[way][best]:.2f}",
                test="R² above 0.9",
                fitted=f"start {start:.1f} m, walking {'left' if way > 0 else 'right'} at {PACE:g} m/s",
                why=f"a car that does not react passes at {min(unhindered):.1f} to {max(unhindered):.1f} m"
                + (
                    ", so that the pedestrian is not in danger and AEB cannot collide"
                    if min(unhindered) > 1.95
                    else ""
                ),
            )
        )
    return claims


Found = tuple[Front, Verdict, int] | None


def _choice_claims(one: Situation, shannon: Found, printed: Found) -> list[Claim]:
    """Return the claims about the candidate that our search chooses."""
    claims = []
    for mode, found in ((EntropyMode.SHANNON, shannon), (EntropyMode.PAPER, printed)):
        experiment = f"{one.name}, NSGA-II, entropy {mode.value}"
        if found is None:
            offset = speed = clearance = float("nan")
        else:
            front, verdict, best = found
            offset, speed = front.genes[best, 0], 3.6 * front.genes[best, 1]
            clearance = verdict.meetings.clearance[best]
        claims.append(
            observed(
                PAPER,
                experiment,
                "The chosen offset and final speed.",
                holds=bool(abs(offset - one.found.offset) < 0.1 and abs(speed - one.found.speed_kmh) < 1.0),
                theirs=f"{one.found.offset:g} m, {one.found.speed_kmh:g} km/h",
                ours=f"{offset:.2f} m, {speed:.2f} km/h",
                test="± 0.1 m, ± 1 km/h",
                why=f"standing still costs nothing, so the final speed is 0; {UNPUBLISHED}",
            )
        )
        claims.append(
            observed(
                PAPER,
                experiment,
                "The chosen candidate touches no pedestrian.",
                holds=bool(clearance > 0.0),
                ours=f"{clearance:.2f} m between the discs",
                test="above 0",
                fitted=START,
                why="without a limit of lateral acceleration",
            )
        )
    return claims


def _physics_claim(one: Situation, verdict: Verdict) -> Claim:
    """Return the claim that a car can drive the paper's candidate."""
    lateral = float(verdict.lateral[0])
    return observed(
        PAPER,
        f"{one.name}, candidate of Table 2",
        f"The path can be driven on a road with a friction of {FRICTION:g}.",
        kind=Kind.OWN,
        holds=lateral <= GRIP,
        ours=f"{lateral:.1f} of {GRIP:.1f}",
        unit="m/s²",
        test="lateral acceleration at most f g",
        fitted="path as long as the distance, first offset that of AEB, full braking without dead time",
        why=f"{float(verdict.total[0]):.1f} m/s² with the braking",
    )
