"""Rows of the collision cones: their gradients, what they guarantee, and which velocity they are about."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.arrays import FloatArray
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.mpc.cone_rows import ConeSettings, Motion, Outline, Walkers, rows

RECTANGLE = Outline(2.25, 0.9, 1.3, None)
DISC = Outline(0.0, 0.0, 1.3, 2.0)
STEPS = 400


def _motion(seed: int) -> Motion:
    drawn = np.random.default_rng(seed)
    return Motion(
        position=drawn.uniform(0.0, 40.0, STEPS),
        across=drawn.uniform(-1.5, 1.5, STEPS),
        heading=drawn.uniform(-0.3, 0.3, STEPS),
        speed=drawn.uniform(0.5, 15.0, STEPS),
        start_heading=0.1,
        start_speed=8.0,
    )


def _walkers(seed: int, side: float) -> Walkers:
    drawn = np.random.default_rng(seed)
    return Walkers(
        x=drawn.uniform(0.0, 60.0, (1, STEPS)),
        y=drawn.uniform(-8.0, 8.0, (1, STEPS)),
        vx=drawn.uniform(-0.5, 0.5, (1, STEPS)),
        vy=drawn.uniform(-1.5, 1.5, (1, STEPS)),
        radius=np.array([0.25]),
        side=np.array([side]),
    )


def _one(x: float, y: float, side: float) -> Walkers:
    """Return one standing pedestrian at one time."""
    place = [np.full((1, 1), value) for value in (x, y, 0.0, 0.0)]
    return Walkers(place[0], place[1], place[2], place[3], np.array([0.25]), np.array([side]))


def _gap(outline: Outline, walkers: Walkers, motion: Motion, after: float) -> FloatArray:
    """Return the true distance between outlines if both keep their velocities for that time."""
    vx, vy = motion.velocity()
    cos, sin = np.cos(motion.heading), np.sin(motion.heading)
    px = walkers.x[0] + walkers.vx[0] * after - motion.position - vx * after - outline.centre * cos
    py = walkers.y[0] + walkers.vy[0] * after - motion.across - vy * after - outline.centre * sin
    x, y = cos * px + sin * py, cos * py - sin * px
    beside = np.maximum(np.abs(x) - outline.half_length, 0.0), np.maximum(np.abs(y) - outline.half_width, 0.0)
    radius = walkers.radius[0] if outline.radius is None else outline.radius
    return np.asarray(np.hypot(*beside) - radius)


@pytest.mark.parametrize("outline", [RECTANGLE, DISC])
@pytest.mark.parametrize("truncation", [np.inf, 3.0, 1.0])
@pytest.mark.parametrize("side", [1.0, -1.0, 0.0])
def test_a_velocity_that_meets_its_row_touches_nobody_within_the_truncation_time(
    outline: Outline, truncation: float, side: float
) -> None:
    motion, walkers = _motion(1), _walkers(2, side)
    value = rows(ConeSettings(Cone.VO, outline, truncation), walkers, motion).value[0]
    apart = np.min(
        [_gap(outline, walkers, motion, t) for t in np.linspace(0.0, min(truncation, 60.0), 1200)], axis=0
    )
    began_apart = _gap(outline, walkers, motion, 0.0) > 0.0
    kept = (value >= 0.0) & began_apart
    assert kept.sum() > 20
    assert apart[kept].min() > -1e-9


@pytest.mark.parametrize("outline", [RECTANGLE, DISC])
def test_without_a_side_the_rows_refuse_nothing_but_collision_courses(outline: Outline) -> None:
    motion, walkers = _motion(3), _walkers(4, 0.0)
    value = rows(ConeSettings(Cone.VO, outline, np.inf), walkers, motion).value[0]
    apart = np.min([_gap(outline, walkers, motion, t) for t in np.linspace(0.0, 120.0, 6000)], axis=0)
    assert (apart[value < -1e-6] < 0.05).all()


@pytest.mark.parametrize("kind", [Cone.VO, Cone.IVO, Cone.HYBRID])
@pytest.mark.parametrize("outline", [RECTANGLE, DISC])
@pytest.mark.parametrize("truncation", [np.inf, 3.0])
def test_gradients_agree_with_finite_differences(kind: Cone, outline: Outline, truncation: float) -> None:
    motion, walkers = _motion(5), _walkers(6, 1.0)
    settings = ConeSettings(kind, outline, truncation)
    about = rows(settings, walkers, motion)

    def velocity_scale(at: Motion) -> FloatArray:
        """The rows are scaled to metres by a time that is held fixed; undo it."""
        vx, vy = at.velocity()
        old_speed, old_heading = at.earlier()
        cos, sin = np.cos(at.heading), np.sin(at.heading)
        px = walkers.x[0] - at.position - outline.centre * cos
        py = walkers.y[0] - at.across - outline.centre * sin
        old_x = old_speed * np.cos(old_heading) - walkers.vx[0]
        old_y = old_speed * np.sin(old_heading) - walkers.vy[0]
        share = {Cone.VO: 0.0, Cone.IVO: 1.0}.get(kind, np.where(px * old_y - py * old_x > 0.0, 1.0, 0.0))
        ux = (1 + share) * vx - share * old_speed * np.cos(old_heading) - walkers.vx[0]
        uy = (1 + share) * vy - share * old_speed * np.sin(old_heading) - walkers.vy[0]
        return np.asarray(np.clip(np.hypot(px, py) / np.hypot(ux, uy), 0.3, 5.0))

    def value(**changed: FloatArray) -> FloatArray:
        moved = replace(motion, **changed)  # type: ignore[arg-type] # fields by name
        return np.asarray(rows(settings, walkers, moved).value[0] / velocity_scale(moved))

    h = 1e-6
    scale = velocity_scale(motion)
    for name in ("position", "across", "heading", "speed"):
        nominal = getattr(motion, name)
        shift = np.zeros(STEPS)
        shift[1::2] = h  # every other one, so that no row sees two changes
        slope = (value(**{name: nominal + shift}) - value(**{name: nominal - shift})) / (2 * h)
        wanted = getattr(about, name)[0] / scale
        odd = np.arange(STEPS) % 2 == 1
        # A few cases lie on a kink, where another corner or the other half-plane takes over.
        assert np.mean(np.isclose(slope, wanted, rtol=1e-3, atol=1e-3)[odd]) > 0.98
        before = getattr(about, name + "_before")[0] / scale if name in ("heading", "speed") else 0.0 * scale
        assert np.mean(np.isclose(slope, before, rtol=1e-3, atol=1e-3)[~odd]) > 0.98


def test_the_interactive_cone_asks_for_half_of_the_change_of_velocity() -> None:
    """Straight at a person standing 20 m away, old speed 8: VO avoids them fully, IVO half."""
    standing = _one(21.3, 1.0, -1.0)

    def value(kind: Cone, heading: float) -> float:
        motion = Motion(np.zeros(1), np.zeros(1), np.full(1, heading), np.full(1, 8.0), 0.0, 8.0)
        return float(rows(ConeSettings(kind, DISC, np.inf), standing, motion).value[0, 0])

    # The right tangent: 1 m to the left at 20 m, half angle asin(2 / d).
    tangent = np.arctan2(1.0, 20.0) - np.arcsin(2.0 / np.hypot(20.0, 1.0))
    assert value(Cone.VO, tangent - 0.01) > 0.0 > value(Cone.VO, tangent + 0.01)
    assert value(Cone.IVO, tangent / 2.0 - 0.01) > 0.0 > value(Cone.IVO, tangent / 2.0 + 0.01)


@pytest.mark.parametrize(("old_heading", "like"), [(-0.2, Cone.IVO), (0.2, Cone.VO)])
def test_the_hybrid_cone_is_interactive_once_the_old_velocity_is_on_the_wanted_side(
    old_heading: float, like: Cone
) -> None:
    standing = _one(21.3, 0.0, -1.0)
    motion = Motion(np.zeros(1), np.zeros(1), np.full(1, -0.1), np.full(1, 7.0), old_heading, 8.0)
    answers = {kind: rows(ConeSettings(kind, DISC, np.inf), standing, motion).value[0, 0] for kind in Cone}
    assert answers[Cone.HYBRID] == answers[like]
    assert answers[Cone.VO] != answers[Cone.IVO]


def test_a_collision_course_beyond_the_truncation_time_does_not_count() -> None:
    ahead = _one(51.3, 0.0, 1.0)
    motion = Motion(np.zeros(1), np.zeros(1), np.zeros(1), np.full(1, 10.0), 0.0, 10.0)
    # 50 m from the body's centre, 2.5 m to the outline: contact in 4.75 s.
    for truncation, free in ((4.7, True), (4.8, False), (np.inf, False)):
        value = rows(ConeSettings(Cone.VO, RECTANGLE, truncation), ahead, motion).value[0, 0]
        assert (value > 0.0) == free


def test_somebody_inside_the_outline_is_driven_away_from() -> None:
    inside = _one(3.0, 0.0, 1.0)
    for speed, fine in ((2.0, False), (-2.0, True)):
        motion = Motion(np.zeros(1), np.zeros(1), np.zeros(1), np.full(1, speed), 0.0, speed)
        value = rows(ConeSettings(Cone.VO, RECTANGLE, np.inf), inside, motion).value[0, 0]
        assert (value > 0.0) == fine
