"""What standing vehicles hide, judged by shapely, and how fast the ego may come to it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import LineString, Point, Polygon, box

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.conflicts import hidden_pedestrians
from controllers.conflicts.hidden_pedestrians import RADIUS, HiddenPedestrian
from controllers.geometry import plane
from controllers.interface import Body, Eyesight, Perception
from controllers.velocity_obstacle.mpc.speed_planning import with_margins
from cosim.sensing import catalog as sensing_catalog
from cosim.step.loop import run
from cosim.step.toy_road import ToyPedestrian, ToyRoad, ToyVehicle, walk
from cosim.step.toy_world import ToyWorld
from tests.controllers.scenes import Car, Walker, bend, perception, straight_road
from tests.controllers.toy_runs import Ride

BAND = (-0.9, 0.9)
RULE = HiddenPedestrian(1.5)
EYES = Eyesight(Body().front - 1.8, 0.0)
BUS = Car(40.0, -3.4, length=12.0, width=2.55)


def _seen(*cars: Car, eyesight: Eyesight | None = EYES) -> Perception:
    return replace(perception(cars=cars), eyesight=eyesight)


def _distances(scene: Perception, eye: tuple[float, float]) -> FloatArray:
    found = hidden_pedestrians.shadows(scene, BAND)
    assert found is not None
    return np.asarray(found.distances(np.array([eye]))[0])


def test_who_brakes_at_once_need_not_see_farther_than_they_react() -> None:
    """``freeze_braking_mps2`` may be infinite."""
    at_once = replace(RULE, braking=float("inf"))
    gap, time = np.array([8.0, 8.0, 0.5]), np.array([0.1, 3.0, at_once.reaction])
    allowed = hidden_pedestrians.assured_speed(gap, time, at_once)
    fast = hidden_pedestrians.UNBOUNDED
    assert allowed == pytest.approx([8.0 / at_once.reaction, fast, at_once.creep], abs=0.05)


def test_the_border_of_what_a_bus_hides_is_the_line_over_its_corner() -> None:
    """Corner at (40, −2.125); 40 m on, the line from the origin would be 4.25 m out."""
    (outward,) = _distances(_seen(BUS), (0.0, 0.0))
    slope = 2.125 / 40.0
    expected = 2.125 + RADIUS * slope + RADIUS * np.hypot(1.0, slope)
    assert outward == pytest.approx(expected, abs=1e-9)


def _outline(car: Car) -> Polygon:
    """``Car.along`` is the front bumper, ``across`` the body's middle."""
    middle = (car.along - 0.5 * car.length * np.cos(car.heading_error), car.across)
    body = box(-0.5 * car.length, -0.5 * car.width, 0.5 * car.length, 0.5 * car.width)
    turned = affinity.rotate(body, car.heading_error, origin=(0.0, 0.0), use_radians=True)
    return affinity.translate(turned, *middle)


def _inner_tangent(eye: tuple[float, float], middle: tuple[float, float], side: float) -> LineString:
    """Return the line of sight that just touches the disc on the side of the path."""
    away = np.array(middle) - eye
    distance = float(np.hypot(*away))
    angle = np.arctan2(away[1], away[0]) - side * np.arcsin(RADIUS / distance)
    reach = np.sqrt(distance**2 - RADIUS**2)
    return LineString([eye, (eye[0] + reach * np.cos(angle), eye[1] + reach * np.sin(angle))])


@pytest.mark.long
@settings(max_examples=600, deadline=None)
@given(
    along=st.floats(10.0, 70.0),
    off=st.floats(0.3, 5.0),
    side=st.sampled_from((-1.0, 1.0)),
    turned=st.floats(-0.5, 0.5),
    length=st.floats(1.5, 18.0),
    width=st.floats(0.6, 2.6),
    eye_along=st.floats(0.0, 60.0),
    eye_across=st.floats(-0.5, 0.5),
)
def test_shapely_sees_the_disc_until_it_is_where_the_border_says(
    along: float,
    off: float,
    side: float,
    turned: float,
    length: float,
    width: float,
    eye_along: float,
    eye_across: float,
) -> None:
    half = 0.5 * (length * abs(np.sin(turned)) + width * np.cos(turned))
    car = Car(along, side * (0.9 + off + half), heading_error=turned, length=length, width=width)
    shape = _outline(car)
    eye = (eye_along, eye_across)
    if shape.bounds[2] - 1.0 < eye_along:
        return
    found = hidden_pedestrians.shadows(_seen(car), BAND)
    if found is None:
        assert shape.bounds[2] <= EYES.ahead
        return
    outward = float(found.distances(np.array([eye]))[0, 0])
    place = float(found.along[0])
    assert place == pytest.approx(shape.bounds[2] + RADIUS, abs=1e-6)
    nearer = _inner_tangent(eye, (place, side * (outward - 1e-3)), side)
    further = _inner_tangent(eye, (place, side * (outward + 1e-3)), side)
    assert not nearer.intersects(shape)
    assert further.intersects(shape)


@pytest.mark.parametrize("radius", [30.0, -45.0])
def test_a_bend_is_laid_out_as_the_circle_it_is(radius: float) -> None:
    road = bend(straight_road(), 0.0, radius, 200.0)
    along, across = np.array([0.0, 7.3, 20.0, 41.9]), np.array([1.0, -2.0, 0.0, 3.0])
    places, heading = plane.to_plane(road, along, across)
    angle = along / radius
    np.testing.assert_allclose(heading, angle, atol=1e-9)
    np.testing.assert_allclose(places[:, 0], (radius - across) * np.sin(angle), atol=0.02)
    np.testing.assert_allclose(places[:, 1], radius - (radius - across) * np.cos(angle), atol=0.02)


def test_what_need_not_slow_the_ego_down_gives_no_limit() -> None:
    def limited(scene: Perception, rule: HiddenPedestrian = RULE) -> bool:
        found = hidden_pedestrians.speed_limit(scene, BAND, rule)
        return found is not None and float(found[1].min()) < 13.0

    assert limited(_seen(BUS))
    assert not limited(_seen(BUS, eyesight=None)), "who is told of everybody"
    assert not limited(_seen(BUS), HiddenPedestrian(0.0)), "switched off"
    assert not limited(_seen(replace(BUS, along_speed=8.0))), "a vehicle that drives"
    assert not limited(_seen(replace(BUS, across=0.3))), "one in the way is followed"
    assert not limited(_seen(replace(BUS, along=2.0))), "one that is passed"
    assert not limited(_seen()), "an empty road"
    queue = Car(130.0, -3.4, length=130.0 - BUS.along - 0.4)
    assert not limited(_seen(BUS, queue)), "nobody fits between two that stand so close"
    assert limited(_seen(BUS, replace(queue, length=queue.length - 0.2)))


@pytest.mark.parametrize(("place", "watched"), [((44.0, 8.0), True), ((150.0, 8.0), False)])
def test_what_a_roadside_unit_watches_is_not_hidden(place: tuple[float, float], watched: bool) -> None:
    eyes = replace(EYES, watched=np.array([[*place, 20.0]]))
    found = hidden_pedestrians.speed_limit(_seen(BUS, eyesight=eyes), BAND, RULE)
    assert (found is None) == watched


def _least_range(across: float, course: float) -> float:
    """Return how far a unit 8 m beside the lane, at the end of the bus, has to see so that nothing is hidden.

    The ego is somewhere in the world, beside the middle of its lane, and its sensor is above that middle.
    """
    along, left = BUS.along, 8.0 - across
    x = 7.0 + along * np.cos(course) - left * np.sin(course)
    y = -3.0 + along * np.sin(course) + left * np.cos(course)
    least, most = 1.0, 60.0
    while most - least > 1e-3:
        middle = 0.5 * (least + most)
        eyes = replace(EYES, left=-across, watched=np.array([[x, y, middle]]))
        seen = _seen(BUS, eyesight=eyes)
        seen = replace(seen, ego=replace(seen.ego, x=7.0, y=-3.0, across=across, heading=course))
        hidden = hidden_pedestrians.speed_limit(seen, BAND, RULE) is not None
        least, most = (middle, most) if hidden else (least, middle)
    return most


@pytest.mark.parametrize(("across", "course"), [(0.5, 0.0), (-0.7, 0.5 * np.pi), (0.5, -2.5)])
def test_where_a_unit_watches_is_known_wherever_the_road_leads(across: float, course: float) -> None:
    straight_east = _least_range(0.0, 0.0)
    assert 10.0 < straight_east < 50.0
    assert _least_range(across, course) == pytest.approx(straight_east, abs=2e-3)


@pytest.mark.long
@settings(max_examples=200, deadline=None)
@given(
    side=st.floats(0.3, 4.0),
    pace=st.floats(0.5, 3.0),
    position=st.floats(0.0, 40.0),
)
def test_at_the_limit_the_ego_stops_or_has_its_front_past_them(
    side: float, pace: float, position: float
) -> None:
    """Stepped through in time, for somebody who steps out at the worst place at any position of the ego."""
    rule = HiddenPedestrian(pace, creep=0.01)
    car = replace(BUS, across=-(0.9 + side + 0.5 * BUS.width))
    scene = _seen(car)
    found, limit = hidden_pedestrians.shadows(scene, BAND), hidden_pedestrians.speed_limit(scene, BAND, rule)
    assert found is not None
    assert limit is not None
    position = float(limit[0][np.searchsorted(limit[0], position)])
    speed = min(float(np.interp(position, *limit)), 30.0)
    outward = found.distances(np.array([[position + EYES.ahead, 0.0]]))[0, 0]
    way = float(found.along[0]) - RADIUS
    front, time, step = position + Body().front, 0.0, 1e-3
    arrives = max(outward - RADIUS - 0.9, 0.0) / pace
    passes = speed > 0.0 and (way - front) / speed <= arrives + step
    while speed > 0.0:
        if time >= rule.reaction:
            speed -= rule.braking * step
        front += max(speed, 0.0) * step
        time += step
    assert passes or front <= way + 0.05


def test_far_from_a_corner_the_ego_brakes_and_then_drives_on_past_it() -> None:
    found = hidden_pedestrians.speed_limit(_seen(BUS), BAND, RULE)
    assert found is not None
    places, allowed = found
    assert allowed.min() >= RULE.creep
    assert allowed[0] > 13.0
    assert allowed[places + Body().front < BUS.along].min() < 6.0
    assert allowed[places + Body().front > BUS.along + RADIUS].min() == hidden_pedestrians.UNBOUNDED
    slowed = hidden_pedestrians.reached(places, allowed, places, 1.5)
    assert (np.diff(slowed**2) >= -2.0 * 1.5 * hidden_pedestrians.SPACING - 1e-9).all()
    assert (slowed <= allowed + 1e-9).all()


def _past_the_bus(step_out: float | None, **parameters: Any) -> Ride:
    """Drive past a bus; somebody steps out when the ego at 13 m/s would need that time to reach them."""
    people = []
    if step_out is not None:
        people.append(ToyPedestrian("child", walk(80.6, -3.0, 0.0, 1.5, start=step_out)))
    world = ToyWorld(
        ToyRoad(),
        people,
        [ToyVehicle("bus", walk(80.0, -3.4, 0.0, 0.0), 12.0, 2.55)],
        speed=13.0,
        duration=16.0,
        sensing=sensing_catalog.build("onboard", {"miss_probability": 0.0}),
    )
    record = Ride()
    run(world, {"ego": catalog.build("vo_mpc", **parameters)}, record)
    return record


def _near(record: Ride) -> float:
    """Return the speed at which the front passed the bus's front."""
    return float(record.track[2][np.flatnonzero(record.track[0] > 80.0)[0]])


@pytest.mark.long
def test_the_ego_slows_down_beside_a_bus_only_when_it_counts_on_somebody() -> None:
    careful, careless = _past_the_bus(None), _past_the_bus(None, hidden_speed_mps=0.0)
    assert _near(careless) > 12.5
    assert _near(careful) < 7.0
    assert careful.track[2].min() > 1.0, "it never stops for somebody who may not be there"
    assert careful.track[2][-1] > 8.0
    assert careful.track[3].min() > -2.5
    assert all(plan.solved for plan in careful.plans)


@pytest.mark.slow
def test_who_steps_out_may_be_hit_by_the_careless_and_never_by_the_careful() -> None:
    """The walk begins when the front is this far from it; that time comes from a ride without pedestrian."""
    hit = {}
    for name, speed in (("careless", 0.0), ("careful", 1.5)):
        alone = _past_the_bus(None, hidden_speed_mps=speed)
        starts = [alone.arrival(80.6 - distance) for distance in (4.0, 6.0, 8.0, 12.0, 16.0, 20.0)]
        hit[name] = sum(_past_the_bus(start, hidden_speed_mps=speed).clearance() <= 0.0 for start in starts)
    assert hit["careless"] >= 2
    assert hit["careful"] == 0


@pytest.mark.long
def test_with_perfect_sensing_nothing_changes_by_a_bit() -> None:
    """A bus, and somebody who steps out from behind it, known to the ego all the time."""

    def drive(**parameters: Any) -> Ride:
        world = ToyWorld(
            ToyRoad(),
            [ToyPedestrian("child", walk(80.6, -3.0, 0.0, 1.5, start=4.0))],
            [ToyVehicle("bus", walk(80.0, -3.4, 0.0, 0.0), 12.0, 2.55)],
            speed=13.0,
            duration=9.0,
        )
        record = Ride()
        run(world, {"ego": catalog.build("vo_mpc", **parameters)}, record)
        return record

    plain, careful = drive(hidden_speed_mps=0.0, uncertainty_gain=0.0), drive()
    np.testing.assert_array_equal(plain.track, careful.track)
    np.testing.assert_array_equal(plain.commands, careful.commands)


def test_margins_grow_with_the_uncertainty_of_a_position() -> None:
    scene = perception(walkers=[Walker(20.0, 1.0), Walker(30.0, 1.0)])
    assert with_margins(scene, 2.0) is scene, "the truth is known"
    unsure = replace(scene, pedestrians=replace(scene.pedestrians, uncertainty=np.array([0.0, 0.4])))
    assert with_margins(unsure, 0.0) is unsure
    np.testing.assert_allclose(with_margins(unsure, 2.0).pedestrians.radius, [0.25, 1.05])


def test_a_hidden_place_is_no_place_in_the_body_of_the_vehicle() -> None:
    found = hidden_pedestrians.shadows(_seen(BUS), BAND)
    assert found is not None
    (outward,) = found.distances(np.array([[0.0, 0.0]]))[0]
    assert Point(found.along[0], -outward).distance(_outline(BUS)) >= RADIUS - 1e-6
