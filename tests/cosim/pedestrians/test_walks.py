"""Walks along lines: exact at every instant, whatever the step."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from controllers.interface import Body, constant_command
from cosim.arrays import FloatArray
from cosim.pedestrians.behaviour import (
    RADIUS,
    Behaviour,
    Leg,
    RoadUser,
    Scene,
    State,
    duration_of,
    reached,
    travelled,
)
from cosim.pedestrians.hesitating import Hesitating
from cosim.pedestrians.line import Line
from cosim.pedestrians.manner import Manner, Pace
from cosim.pedestrians.recorded import Recorded
from cosim.pedestrians.running import Running
from cosim.pedestrians.start import AtTime, EgoNear, Impact, Start, WhenClear, WhileSignal
from cosim.pedestrians.steady import Steady
from cosim.pedestrians.swerving import Swerving
from cosim.pedestrians.turning_back import TurningBack
from cosim.pedestrians.walker import Walker
from cosim.step.plant import CAR_DRIVE, Plant
from cosim.step.toy_road import ToyPedestrian, ToyRoad
from cosim.step.toy_world import ToyWorld
from tests.cosim.pedestrians.toy_walk import ToyWalk

ACROSS = Line(50.0, -4.0, 50.0, 4.0)
NOBODY = Scene(0.0)


def walker(
    manner: Manner | None = None,
    start: Start | None = None,
    speed: float = 1.0,
    ramp: float = 0.0,
    length: float = ACROSS.length,
    stay: float = 0.0,
    ego: str = "",
) -> Walker:
    return Walker(
        ACROSS, Pace(speed, ramp), manner or Steady(), start or AtTime(2.0), length, stay=stay, ego=ego
    )


def ego_at(time: float, speed: float = 10.0, x: float = 0.0, y: float = 0.0, name: str = "ego") -> RoadUser:
    """Return an ego that drives east at a constant speed."""
    return RoadUser(name, x + speed * time, y, 0.0, speed)


def states(
    behaviour: Behaviour, step: float, until: float = 60.0, speed: float = 10.0, x: float = -200.0
) -> Iterator[tuple[float, State]]:
    """Yield somebody's states while an ego passes."""
    time, state = 0.0, None
    while time < until:
        scene = Scene(time, (ego_at(time, speed, x),))
        state = behaviour.first(scene) if state is None else behaviour.next(state, scene, time + step)
        if state is None:
            return
        time += step
        yield time, state


@pytest.mark.parametrize("step", [0.05, 0.1, 0.37, 1.0])
def test_somebody_who_sets_off_between_two_steps_is_where_they_ought_to_be(step: float) -> None:
    # first() returns the state at that very time, so the clock of the first state is one step late here.
    who = walker(start=AtTime(2.03), speed=1.4, ramp=0.7)
    state = who.first(NOBODY)
    assert state is not None
    time = 0.0
    while time < 6.0:
        after = who.next(state, Scene(time), time + step)
        assert after is not None
        state, time = after, time + step
        elapsed = max(time - 2.03, 0.0)
        # v = 1.4 after 0.7 m: a = 1.4 m/s², reached after 1 s.
        way = 0.7 * elapsed**2 if elapsed < 1.0 else 0.7 + 1.4 * (elapsed - 1.0)
        assert (state.x, state.y) == pytest.approx((50.0, -4.0 + way), abs=1e-9)
        assert state.y_speed == pytest.approx(min(1.4 * elapsed, 1.4), abs=1e-9)


@given(
    speed=some.floats(0.3, 5.0),
    ramp=some.floats(0.0, 3.0),
    after=some.floats(0.1, 9.0),
    pause=some.floats(0.0, 4.0),
    kind=some.sampled_from(["steady", "hesitating", "running", "turning_back"]),
)
def test_planned_walks_have_the_length_and_the_time_that_they_ought_to(
    speed: float, ramp: float, after: float, pause: float, kind: str
) -> None:
    pace = Pace(speed, ramp)
    manners: dict[str, Manner] = {
        "steady": Steady(),
        "hesitating": Hesitating(after, pause),
        "running": Running(6.0, after),
        "turning_back": TurningBack(after, pause),
    }
    manner = manners[kind]
    legs = manner.legs(pace, 8.0)
    way, still = travelled(legs, duration_of(legs) + 1e-9)
    assert still == 0.0
    assert way == pytest.approx(0.0 if kind == "turning_back" and after < 8.0 else 8.0, abs=1e-6)
    # Nobody jumps: between two instants they move by no more than their greatest speed allows.
    times = np.linspace(0.0, duration_of(legs), 400)
    ways = np.array([travelled(legs, float(time))[0] for time in times])
    assert np.abs(np.diff(ways)).max() <= max(6.0, speed) * (times[1] - times[0]) + 1e-9
    # Reaching a place is the inverse of having walked there.
    for place in (0.05, 0.5 * min(after, 8.0)):
        assert travelled(legs, reached(legs, place))[0] == pytest.approx(place, abs=1e-6)


def test_a_place_that_is_never_reached_is_reached_at_no_time() -> None:
    assert math.isinf(reached((Leg(2.0, 1.0),), 3.0))


@pytest.mark.parametrize("step", [0.05, 0.1, 0.25])
@pytest.mark.parametrize("overlap", [0.0, 0.25, 0.5, 0.75, 1.0])
@pytest.mark.parametrize("ego_speed", [10 / 3.6, 40 / 3.6, 60 / 3.6])
@pytest.mark.parametrize("from_left", [False, True])
def test_the_impact_is_where_on_the_front_it_is_asked_for(
    step: float, overlap: float, ego_speed: float, from_left: bool
) -> None:
    """The geometry of the protocols: an ego that keeps its speed touches the pedestrian at that share of its width."""
    line = Line(50.0, 4.0, 50.0, -4.0) if from_left else ACROSS
    pace = Pace(5 / 3.6, 1.0)
    start = Impact(line, overlap, Steady().legs(pace, line.length))
    who = Walker(line, pace, Steady(), start, line.length, ego="ego")
    y = 0.1  # a car is seldom in the very middle of its lane
    time, state = 0.0, None
    x = 50.0 - 8.0 * ego_speed
    touch = (50.0 - RADIUS - x) / ego_speed
    while time < touch:
        scene = Scene(time, (ego_at(time, ego_speed, x, y),))
        state = who.first(scene) if state is None else state
        if state is not None:
            state = who.next(state, scene, min(time + step, touch))
        time += step
    assert state is not None
    side = 0.9 if from_left else -0.9
    wanted = y + side - math.copysign(1.8 * overlap, side)
    assert state.y == pytest.approx(wanted, abs=1e-6)
    assert abs(state.y_speed) == pytest.approx(5 / 3.6)


def test_a_nominal_speed_makes_them_set_off_at_a_distance_whatever_the_ego_does() -> None:
    legs = Steady().legs(Pace(1.0), 8.0)
    start = Impact(ACROSS, 0.5, legs, speed=10.0)
    # The walk to the middle takes 4 s: the front bumper is 40.25 m away at the start.
    for speed in (5.0, 10.0, 20.0):
        at = start.instant(Scene(0.0, (ego_at(0.0, speed, 0.0),)), 100.0)
        assert at == pytest.approx((50.0 - 40.25) / speed)


def test_an_ego_that_is_near_enough_in_metres_or_seconds_makes_them_set_off() -> None:
    scene = Scene(1.0, (ego_at(0.0, 10.0, 0.0),))
    assert EgoNear(ACROSS, distance=20.0).instant(scene, 100.0) == pytest.approx(1.0 + 3.0)
    assert EgoNear(ACROSS, arrival=3.0).instant(scene, 100.0) == pytest.approx(1.0 + 2.0)
    assert EgoNear(ACROSS, distance=20.0).instant(scene, 3.9) is None
    assert EgoNear(ACROSS, distance=20.0, ego="another").instant(scene, 100.0) is None
    # Along the lane nothing crosses: then the beginning of the line counts.
    along = Line(50.0, 0.0, 90.0, 0.0)
    assert EgoNear(along, distance=20.0).instant(scene, 100.0) == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("x", "speed", "clear"),
    [(0.0, 10.0, False), (-40.0, 10.0, True), (48.0, 12.0, True), (20.0, 0.0, True), (60.0, 10.0, True)],
)
def test_a_gap_is_accepted_when_every_vehicle_comes_late_enough_or_is_past(
    x: float, speed: float, clear: bool
) -> None:
    # They are in the path of a car in the middle from 2.85 m on, after 2.85 s.
    start = WhenClear(AtTime(0.0), ACROSS, 4.0, 1.0)
    scene = Scene(0.5, (), (ego_at(0.0, speed, x),))
    assert (start.instant(scene, 0.6) is not None) is clear


def test_they_wait_for_red_and_for_green_but_not_for_a_signal_that_is_off() -> None:
    red = WhileSignal(AtTime(0.0), "c", False)
    assert red.instant(Scene(1.0, green={"c": False}), 1.1) == 1.0
    assert red.instant(Scene(1.0, green={"c": True}), 1.1) is None
    assert red.instant(Scene(1.0), 1.1) is None
    assert WhileSignal(AtTime(0.0), "c", True).instant(Scene(1.0, green={"c": True}), 1.1) == 1.0


def test_who_runs_from_an_ego_is_over_sooner_and_who_turns_comes_back() -> None:
    steady = [state for _, state in states(walker(start=AtTime(20.0), speed=1.0), 0.1)]
    runs = [state for _, state in states(walker(Running(3.0, ego_within=3.0), AtTime(20.0)), 0.1)]
    turns = [state for _, state in states(walker(TurningBack(ego_within=3.0), AtTime(20.0)), 0.1)]
    assert len(runs) < len(steady) - 30
    assert max(state.y_speed for state in runs) == pytest.approx(3.0)
    assert max(state.y for state in turns) < 0.0
    assert turns[-1].y == pytest.approx(-4.0, abs=0.11)
    assert min(state.y_speed for state in turns) == pytest.approx(-1.0)


@pytest.mark.parametrize("step", [0.05, 0.1, 0.37])
def test_a_watchful_pedestrian_who_waits_before_a_standing_vehicle_says_so(step: float) -> None:
    """While they do not move, their velocity is 0 too: whoever believes it would wait for them for ever."""
    who = replace(walker(Running(3.0, ego_within=4.0), AtTime(0.0)), watches=1.5)
    found = list(states(who, step, 20.0, speed=0.0, x=50.5))
    places = [state.y for _, state in found]
    stands = [now for before, now in itertools.pairwise(places) if now == before]
    assert len(stands) > 10.0 / step, "it waits to the end"
    assert max(stands) < -0.9 - RADIUS
    waiting = [state.y_speed for _, state in found[-len(stands) :]]
    assert waiting == [0.0] * len(stands)
    assert max(len(state.legs) for _, state in found) <= 5, "a long wait is one pause, not one for each step"


def test_beside_a_car_that_stands_askew_its_body_counts_and_ahead_its_way() -> None:
    """Its tail juts out by 4.5 m sin 0.2 to the left of its way, which leads straight on."""

    def straight_on(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        return points[:, 0] - 50.0, points[:, 1]

    car = RoadUser("ego", 50.0, 0.0, -0.2, 0.3, way=straight_on)
    places = np.array([[50.0 - 3.0 * math.cos(0.2), 3.0 * math.sin(0.2) + 1.0], [60.0, 1.0], [40.0, 1.0]])
    along, across = car.sees(places)
    assert along.tolist() == pytest.approx([-3.0 - math.sin(0.2), 10.0, -10.0])
    assert across.tolist() == pytest.approx([math.cos(0.2), 1.0, 1.0])
    line = Line(47.0, 5.0, 47.0, -5.0)
    meeting = line.meeting(car)
    assert meeting is not None
    touches = 5.0 - 3.0 * math.tan(0.2) - (0.9 + RADIUS) / math.cos(0.2)
    assert meeting.enters == pytest.approx(touches, abs=0.01)
    # Past the tail, obliquely: whoever looked at the way from there on would see room where the flank is.
    behind = Line(46.5, 3.0, 43.5, -3.0)
    _, beside = replace(car, way=None).sees(np.array([behind.point(0.0), behind.point(1.0)]))
    meeting = behind.meeting(car)
    assert meeting is not None
    touches = (beside[0] - 0.9 - RADIUS) / (beside[0] - beside[1])
    assert meeting.enters == pytest.approx(touches, abs=0.01)


def test_who_hesitates_stands_where_and_as_long_as_they_are_said_to() -> None:
    found = list(states(walker(Hesitating(3.0, 2.0), AtTime(1.0)), 0.1))
    standing = [
        time for time, state in found if state.started is not None and state.y_speed == 0.0 and state.y < 3.9
    ]
    assert {round(state.y, 6) for time, state in found if time in standing} == {-1.0}
    assert len(standing) == pytest.approx(20, abs=1)


def test_they_stay_at_the_end_and_then_is_gone() -> None:
    found = list(states(walker(start=AtTime(1.0), length=3.0, stay=2.0), 0.1))
    assert found[-1][1].y == pytest.approx(-1.0)
    assert found[-1][0] == pytest.approx(1.0 + 3.0 + 2.0, abs=0.15)


def test_somebody_who_waits_for_an_ego_comes_into_view_when_it_is_near() -> None:
    who = walker(start=EgoNear(ACROSS, distance=30.0, ego="ego"), ego="ego")
    assert who.first(Scene(0.0, (ego_at(0.0, 10.0, -300.0),))) is None
    assert who.first(Scene(0.0, (ego_at(0.0, 10.0, -50.0),))) is not None
    assert who.first(Scene(0.0, (ego_at(0.0, 10.0, -50.0, name="another"),))) is None


def test_they_mean_to_walk_over_the_next_metres_of_their_line_or_back() -> None:
    who = walker(TurningBack(after=2.0), AtTime(0.0))
    state = who.first(NOBODY)
    assert state is not None
    assert who.onward(state, 0.0)[-1].tolist() == pytest.approx([50.0, -1.0])
    for time, end in ((1.0, -4.0), (3.0, -4.0)):
        later = who.next(state, NOBODY, time)
        assert later is not None
        assert who.onward(later, time)[-1].tolist() == pytest.approx([50.0, end], abs=0.01)


def test_a_recording_is_replayed_linearly_and_to_the_millimetre() -> None:
    generator = np.random.default_rng(5)
    times = np.cumsum(generator.uniform(0.05, 0.4, 60))
    points = np.column_stack([times, np.cumsum(generator.normal(0.0, 0.2, (60, 2)), axis=0)])
    replay = Recorded(points, start=100.0)
    for time, x, y in points.tolist():
        assert replay.at(100.0 + time)[:2] == pytest.approx((x, y), abs=1e-9)
    middle = 0.5 * (points[:-1] + points[1:])
    for time, x, y in middle.tolist():
        assert replay.at(100.0 + time)[:2] == pytest.approx((x, y), abs=1e-9)
    assert replay.first(Scene(100.0)) is None
    assert replay.first(Scene(100.0 + times[0])) is not None
    assert replay.next(State(0.0, 0.0), Scene(110.0), 100.0 + times[-1] + 0.1) is None


@pytest.mark.parametrize("step", [0.05, 0.1])
def test_the_social_force_pushes_a_walker_away_from_a_car_that_stands_beside_them(step: float) -> None:
    who = Swerving(walker(start=AtTime(0.0), speed=1.25), seed=3)
    beside = RoadUser("car", 49.0, 0.0, 0.0, 0.0)

    def ends(vehicles: tuple[RoadUser, ...]) -> list[State]:
        state, time, found = who.first(NOBODY), 0.0, []
        while state is not None and time < 30.0:
            found.append(state)
            state = who.next(state, Scene(time, (), vehicles), time + step)
            time += step
        return found

    free, pushed = ends(()), ends((beside,))
    assert free[-1].y == pytest.approx(4.0, abs=RADIUS + 0.1)
    assert max(abs(state.x - 50.0) for state in free) < 0.05
    assert max(state.x for state in pushed) > 50.5
    assert pushed[-1].y > 3.5
    # The same seed gives the same unevenness; another one another.
    assert ends(()) == free
    assert [s.y for s in states_of(Swerving(who.walker, seed=4), step)] != [s.y for s in free][: len(free)]


def states_of(behaviour: Behaviour, step: float) -> list[State]:
    state, time, found = behaviour.first(NOBODY), 0.0, []
    while state is not None and time < 30.0:
        found.append(state)
        state = behaviour.next(state, Scene(time), time + step)
        time += step
    return found


def test_a_behaviour_walks_on_the_toy_road_and_meets_the_ego_as_planned() -> None:
    line = Line(60.0, -5.0, 60.0, 5.0)
    pace = Pace(5 / 3.6, 1.0)
    who = Walker(
        line, pace, Steady(), Impact(line, 0.25, Steady().legs(pace, line.length)), line.length, ego="ego"
    )
    motion = ToyWalk(who, Plant(Body(), CAR_DRIVE, 0.0, 0.0, 0.0, 10.0))
    world = ToyWorld(ToyRoad(), (ToyPedestrian("somebody", motion),), speed=10.0, duration=7.0)
    contact = None
    while (perceptions := world.sense()) is not None:
        world.act(perceptions[0].ego.name, constant_command(0.0, 0.0))
        before = world.snapshot()
        world.advance()
        after = world.snapshot()
        limit = 60.0 - RADIUS
        if before.egos[0].x < limit <= after.egos[0].x:
            share = (limit - before.egos[0].x) / (after.egos[0].x - before.egos[0].x)
            contact = before.persons.y[0] + share * (after.persons.y[0] - before.persons.y[0])
    assert contact == pytest.approx(-0.9 + 0.25 * 1.8, abs=0.001)


def test_somebody_who_only_stands_is_there_as_long_as_they_stay() -> None:
    found = list(states(walker(start=AtTime(0.0), length=0.0, stay=5.0), 0.1))
    assert {(state.x, state.y, state.y_speed) for _, state in found} == {(50.0, -4.0, 0.0)}
    assert found[-1][0] == pytest.approx(5.0, abs=0.11)


def test_an_impact_on_a_bend_counts_the_way_along_it() -> None:
    """A turning car, as in the protocols' turning cases: its way is a quarter circle of 10 m radius."""
    radius, speed = 10.0, 4.0
    line = Line(6.0, 14.0, 14.0, 6.0)  # meets the arc at right angles
    pace = Pace(1.4)
    start = Impact(line, 0.5, Steady().legs(pace, line.length))
    who = Walker(line, pace, Steady(), start, line.length)

    def ego(time: float) -> RoadUser:
        gone = speed * (time - 6.0) / radius  # angle on the circle around (0, 20), from its lowest point

        def way(points: FloatArray) -> tuple[FloatArray, FloatArray]:
            angle = np.arctan2(points[:, 0], 20.0 - points[:, 1])
            return radius * (angle - gone), radius - np.hypot(points[:, 0], 20.0 - points[:, 1])

        return RoadUser("ego", radius * math.sin(gone), 20.0 - radius * math.cos(gone), gone, speed, way=way)

    state, time = who.first(NOBODY), 0.0
    while state is not None and time < 20.0:
        along, across = ego(time).ahead(state.x, state.y)
        if along <= RADIUS + speed * 0.025:
            break
        state, time = who.next(state, Scene(time, (ego(time),)), time + 0.05), time + 0.05
    assert state is not None
    # Half a step of the pedestrian and of the car remains.
    assert abs(across) < 0.08
