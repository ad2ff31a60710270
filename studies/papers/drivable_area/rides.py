"""The four situations of the drivable-area paper in closed loop, on the road without SUMO."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.drivable_area.clearances import Shape
from controllers.interface import Body, Decision, Perception, Plan
from cosim.step.loop import ToWorld, run
from cosim.step.toy_road import ToyPedestrian, ToyRoad, walk
from cosim.step.toy_world import ToyWorld
from cosim.step.world import Snapshot
from studies.papers.claim import Claim, Kind, observed
from studies.papers.drivable_area.scenes import (
    DEAD_TIME,
    FRICTION,
    LANE_WIDTH,
    NUMBER,
    OWN,
    PACE,
    RAMP,
    SEED,
    START,
    WALKER,
    Situation,
)

BEHIND = 10.0
"""The time of a ride is taken at this distance beyond the pedestrian [m]."""


@dataclass(slots=True)
class Ride:
    """A closed-loop ride on the road without SUMO, and its record."""

    times: list[float]
    truth: list[tuple[float, float, float, float]]
    """Front x, front y, heading and speed after every step [m, m, rad, m/s]."""
    walker: list[tuple[float, float]]
    statuses: list[str]
    body: Body

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Record a plan's status."""
        self.statuses.append(plan.status)

    def stepped(self, snapshot: Snapshot) -> None:
        """Record the state after a step."""
        ego = snapshot.egos[0]
        self.times.append(snapshot.time)
        self.truth.append((ego.x, ego.y, ego.heading, ego.speed))
        self.walker.append((float(snapshot.persons.x[0]), float(snapshot.persons.y[0])))

    @property
    def track(self) -> FloatArray:
        """Front x, front y, heading and speed after every step, shape (4, K)."""
        return np.array(self.truth).T

    @property
    def clearances(self) -> FloatArray:
        """Distance between the car's rectangle and the pedestrian's disc of 0.25 m, shape (K,) [m]."""
        x, y, heading, _ = self.track
        walker_x, walker_y = np.array(self.walker).T
        rear_x = x - self.body.front * np.cos(heading)
        rear_y = y - self.body.front * np.sin(heading)
        shape = Shape(self.body, pedestrian_radius=0.25)
        return shape.clearance(rear_x, rear_y, heading, walker_x, walker_y)

    @property
    def clearance(self) -> float:
        """Smallest distance between car and pedestrian; negative on contact [m]."""
        return float(self.clearances.min())

    @property
    def impact_speed(self) -> float | None:
        """Speed at the first contact; ``None`` without one [m/s]."""
        touched = np.flatnonzero(self.clearances < 0.0)
        return float(self.track[3][touched[0]]) if len(touched) else None

    def passes(self, place: float) -> float:
        """Return when the front has travelled the distance ``place``; inf if it never does [s]."""
        beyond = np.flatnonzero(self.track[0] >= place + self.body.front)
        return self.times[beyond[0]] if len(beyond) else float("inf")

    @property
    def lateral_acceleration(self) -> float:
        """Largest v · dψ/dt between steps [m/s^2]."""
        turned = np.diff(self.track[2]) / np.diff(self.times)
        return float(np.abs(turned * 0.5 * (self.track[3][1:] + self.track[3][:-1])).max())


def driven(situation: Situation, controller: str, **parameters: object) -> Ride:
    """Return a ride in a situation: two lanes, the ego in the right one, with the default car's lags."""
    world = ToyWorld(
        ToyRoad(lanes=2, lane_width=LANE_WIDTH, speed_limit=situation.speed),
        [ToyPedestrian("pedestrian", walk(Body().front + situation.distance, WALKER - OWN, 0.0, -PACE))],
        speed=situation.speed,
        duration=8.0,
        step=0.05,
    )
    ride = Ride([], [], [], [], world.body)
    run(world, {"ego": catalog.build(controller, seed=SEED, **parameters)}, ride)
    return ride


@dataclass(frozen=True, slots=True)
class Rides:
    """The closed-loop rides of one situation."""

    brake: Ride
    loose: Ride
    """The paper's method with candidates beyond the friction limit."""
    strict: Ride
    """The paper's method within the friction limit."""


def rides_in(one: Situation) -> Rides:
    """Return the rides of AEB and of the method, with and without the friction limit."""
    return Rides(
        driven(one, "aeb", friction=FRICTION, dead_time_s=DEAD_TIME, ramp_s=RAMP),
        driven(one, "drivable_area", friction=FRICTION, progress_weight=0.0, within_friction=False),
        driven(one, "drivable_area", friction=FRICTION, progress_weight=0.0),
    )


def ride_claims(one: Situation, rides: Rides) -> list[Claim]:
    """Return the claims about the closed-loop rides."""
    experiment = f"{one.name}, closed loop"
    brakes, loose, strict = rides.brake, rides.loose, rides.strict
    collides = not np.isfinite(one.brake.distance)
    claims = [
        observed(
            NUMBER,
            experiment,
            "AEB collides." if collides else "AEB does not collide.",
            holds=(brakes.clearance < 0.0) == collides,
            theirs=f"cost_d {one.brake.distance:g}",
            ours=_outcome(brakes),
            test="least distance of the bodies",
            fitted=START,
            why="it never brakes: the pedestrian has left the way by then"
            if brakes.track[3].min() > 0.99 * one.speed
            else "",
        ),
        observed(
            NUMBER,
            experiment,
            "The method does not collide.",
            holds=loose.clearance > 0.0,
            ours=_outcome(loose),
            test="least distance of the bodies above 0",
            fitted=START,
            why="candidates may exceed the friction; largest lateral acceleration "
            f"{loose.lateral_acceleration:.1f} m/s²",
        ),
        observed(
            NUMBER,
            experiment,
            f"The method does not collide where the tyres hold {FRICTION:g} g.",
            kind=Kind.OWN,
            holds=strict.clearance > 0.0,
            ours=_outcome(strict),
            test="least distance of the bodies above 0",
            fitted=START,
            why="no candidate is possible: the declared fallback, full braking"
            if "no_feasible_candidate" in strict.statuses
            else "",
        ),
    ]
    if not collides:
        place = one.distance + BEHIND
        claims.append(
            observed(
                NUMBER,
                experiment,
                "The method gets on faster than AEB.",
                holds=strict.passes(place) < brakes.passes(place),
                ours=f"{strict.passes(place):.2f} against {brakes.passes(place):.2f}",
                unit="s",
                test=f"{BEHIND:g} m beyond the pedestrian sooner",
                fitted=START,
                why="entropy shannon, within the friction",
            )
        )
    return claims


def _outcome(ride: Ride) -> str:
    impact = ride.impact_speed
    if impact is not None:
        return f"contact at {3.6 * impact:.1f} km/h"
    return f"{ride.clearance:.2f} m"
