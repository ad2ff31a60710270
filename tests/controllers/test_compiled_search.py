"""The search near the last active rows, compiled, against the same search as NumPy runs it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from controllers.interface import FloatArray
from controllers.programs.active_set import ActiveSet, IntArray, Optimum
from cosim.toy_world import ToyCrossing, ToyRoad, walk
from tests.controllers.toy_runs import ride

pytest.importorskip("numba")

VARIABLES, ROWS, MANY = 9, 40, 200
NOBODY = np.empty(0, dtype=np.int64)
ACTIVE = 1e-7
"""Rows with smaller multipliers may be counted as active or not."""

Drawn = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


def _drawn(seed: int, alike: float, feasible: bool = True) -> Drawn:
    """Return a strictly convex program; neighbouring rows are alike, some are without bound, some are bounds."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(VARIABLES, VARIABLES))
    rows = rng.normal(size=(ROWS, VARIABLES))
    for i in range(1, ROWS):
        rows[i] = alike * rows[i - 1] + (1.0 - alike) * rows[i]
    A = np.concatenate((rows, np.eye(VARIABLES), -np.eye(VARIABLES)))
    b = A @ rng.uniform(-0.5, 0.5, VARIABLES) + rng.uniform(0.0, 0.5, len(A))
    b[rng.random(len(b)) < 0.2] = np.inf
    if not feasible:
        A[5], b[4], b[5] = -A[4], -1.0, -1.0
    return root @ root.T + 0.3 * np.eye(VARIABLES), 5.0 * rng.normal(size=VARIABLES), A, b


def _all_ways(program: Drawn, guess: IntArray, most: int) -> list[Optimum | None]:
    """Search as NumPy does, compiled by the factor, and compiled by the inverse of the cost matrix."""
    plain, factor, inverse = ActiveSet(), ActiveSet(compiled=True), ActiveSet(compiled=True, constant=True)
    return [near.resume(*program, guess, most) for near in (plain, factor, inverse)]


def _is_the_same(one: Optimum, other: Optimum) -> bool:
    binding = [set(found.active[found.multipliers > ACTIVE].tolist()) for found in (one, other)]
    return bool(
        binding[0] == binding[1]
        and np.allclose(one.z, other.z, rtol=0.0, atol=1e-9)
        and np.isclose(one.cost, other.cost, rtol=1e-9, atol=1e-9)
    )


def _kept(program: Drawn, found: Optimum) -> bool:
    """Say whether the optimality conditions hold."""
    P, q, A, b = program
    over = A @ found.z - b
    return bool(
        over.max() < 1e-7
        and np.abs(over[found.active]).max(initial=0.0) < 1e-7
        and (found.multipliers >= 0.0).all()
        and np.abs(P @ found.z + q + A[found.active].T @ found.multipliers).max() < 1e-7
        and np.isclose(found.cost, 0.5 * found.z @ P @ found.z + q @ found.z, atol=1e-7)
    )


@pytest.mark.parametrize("alike", [0.0, 0.5, 0.9])
def test_from_any_guess_both_find_the_same_optimum(alike: float) -> None:
    for seed in range(150):
        program = _drawn(seed, alike)
        rng = np.random.default_rng(seed)
        everything = rng.permutation(len(program[3]))
        for guess in (NOBODY, everything[:3], everything[:VARIABLES], everything):
            plain, *compiled = _all_ways(program, guess, MANY)
            assert plain is not None
            assert _kept(program, plain)
            for found in compiled:
                assert found is not None
                assert _kept(program, found)
                assert _is_the_same(found, plain)


def test_both_need_no_change_from_the_right_guess_and_none_is_made_when_none_may_be() -> None:
    found_at_once = 0
    for seed in range(50):
        program = _drawn(seed, 0.5)
        plain, *_ = _all_ways(program, NOBODY, MANY)
        assert plain is not None
        for again in _all_ways(program, plain.active, 0):
            assert again is not None
            assert _is_the_same(again, plain)
        for again in _all_ways(program, NOBODY, 0):
            assert (again is None) == (len(plain.active) > 0)
        found_at_once += len(plain.active) == 0
    assert found_at_once < 50


def test_both_give_up_after_as_many_changes_as_they_may_make() -> None:
    for seed in range(20):
        program = _drawn(seed, 0.5)
        plain, *_ = _all_ways(program, NOBODY, MANY)
        assert plain is not None
        for most in range(len(plain.active)):
            assert _all_ways(program, NOBODY, most) == [None, None, None]


def test_no_optimum_where_rows_exclude_each_other() -> None:
    for seed in range(50):
        program = _drawn(seed, 0.3, feasible=False)
        assert _all_ways(program, NOBODY, MANY) == [None, None, None]
        assert _all_ways(program, np.array([4]), MANY) == [None, None, None]


def test_a_guess_of_rows_that_depend_on_each_other_does_no_harm() -> None:
    for seed in range(30):
        P, q, A, b = _drawn(seed, 0.0)
        A[1], b[1], A[2], b[2] = A[0], b[0], 2.0 * A[0], 2.0 * b[0]
        plain, *compiled = _all_ways((P, q, A, b), np.array([0, 1, 2, 0]), MANY)
        assert plain is not None
        assert _kept((P, q, A, b), plain)
        for found in compiled:
            assert found is not None
            # Which of the equal rows is active is anybody's choice.
            assert _kept((P, q, A, b), found)
            assert np.allclose(found.z, plain.z, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("alike", [0.9999, 1.0 - 1e-9, 1.0])
def test_rows_that_are_almost_alike_or_equal_do_no_harm(alike: float) -> None:
    for seed in range(60):
        program = _drawn(seed, alike)
        everything = np.random.default_rng(seed).permutation(len(program[3]))
        for guess in (NOBODY, everything[:VARIABLES], everything):
            plain, *compiled = _all_ways(program, guess, MANY)
            assert plain is not None
            assert _kept(program, plain)
            for found in compiled:
                assert found is not None
                assert _kept(program, found)
                assert np.allclose(found.z, plain.z, rtol=0.0, atol=1e-6)


@pytest.mark.slow
def test_compiled_code_stays_within_its_arrays(tmp_path: Path) -> None:
    # Numba checks no index unless told to: what is written elsewhere would not be noticed here.
    checked = {**os.environ, "NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow", __file__]
    done = subprocess.run(command, env=checked, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.filterwarnings("ignore:invalid value encountered")
@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf])
def test_what_is_not_a_number_anywhere_gives_no_answer(number: float) -> None:
    rng = np.random.default_rng(1)
    for seed in range(20):
        for part in range(4):
            program = _drawn(seed, 0.5)
            if part == 3 and number == np.inf:  # means: no bound
                continue
            place = tuple(rng.integers(0, size) for size in program[part].shape)
            if part == 2:  # a row without bound is never looked at
                place = (rng.choice(np.flatnonzero(np.isfinite(program[3]))), place[1])
            program[part][place] = number
            if part == 0:
                program[part][place[::-1]] = number
            for guess in (NOBODY, np.arange(5)):
                assert _all_ways(program, guess, MANY) == [None, None, None]


def test_a_cost_matrix_that_is_not_positive_definite_has_no_optimum_and_does_no_harm() -> None:
    for constant in (False, True):
        near, (P, q, A, b) = ActiveSet(compiled=True, constant=constant), _drawn(2, 0.5)
        for _ in range(2):
            assert near.resume(P - 100.0 * np.eye(VARIABLES), q, A, b, NOBODY, MANY) is None
        found = near.resume(P, q, A, b, NOBODY, MANY)
        assert found is not None
        assert _kept((P, q, A, b), found)


def test_what_was_searched_before_leaves_no_trace() -> None:
    for constant in (False, True):
        program, other = _drawn(7, 0.5), _drawn(8, 0.5)
        once = ActiveSet(compiled=True, constant=constant).resume(*program, NOBODY, MANY)
        near = ActiveSet(compiled=True, constant=constant)
        near.resume(*other, NOBODY, MANY)
        twice = [near.resume(*program, NOBODY, MANY) for _ in range(2)]
        for found in twice:
            assert once is not None
            assert found is not None
            np.testing.assert_array_equal(found.z, once.z)


@pytest.fixture(scope="module")
def recorded() -> list[tuple[Drawn, IntArray]]:
    """Return every program that an ego solves on its way past five pedestrians, with the guess."""
    kept: list[tuple[Drawn, IntArray]] = []
    resume = ActiveSet.resume

    def keep(
        near: ActiveSet,
        P: FloatArray,
        q: FloatArray,
        A: FloatArray,
        b: FloatArray,
        guess: IntArray,
        most: int,
    ) -> Optimum | None:
        kept.append(((P.copy(), q.copy(), A.copy(), b.copy()), guess.copy()))
        return resume(near, P, q, A, b, guess, most)

    people = [walk(62.0 + 0.4 * i, -6.0 + 3.0 * i, 0.0, (-1.0) ** i * (1.1 + 0.1 * i)) for i in range(5)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ActiveSet, "resume", keep)
        ride(ToyRoad(crossings=(ToyCrossing(60.0),)), people, duration=10.0)
    return kept


def test_both_find_the_optimum_of_a_drive_s_programs(recorded: list[tuple[Drawn, IntArray]]) -> None:
    assert len(recorded) > 200
    found_by_both = 0
    for program, guess in recorded:
        for begin in (guess, NOBODY):
            plain, *compiled = _all_ways(program, begin, 60)
            for found in compiled:
                assert (found is None) == (plain is None)
                if found is not None and plain is not None:
                    found_by_both += 1
                    assert _kept(program, found)
                    assert _is_the_same(found, plain)
    assert found_by_both > 3.5 * len(recorded)
