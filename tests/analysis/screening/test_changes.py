"""What an alternative changes at crossings, on counts whose truth is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from analysis.errors import StudyError
from analysis.files import read_csv
from analysis.screening.changes import CHANGES, TOTAL, change_rows
from analysis.screening.counts import Counts
from analysis.screening.writing import write_changes
from analysis.tables.cells import Row, cells

RUNS, WALKS = 10, 40
NAMES = tuple(f":{place}_c0" for place in "abcdefghijklmnopqrst")
RATES = np.full(len(NAMES), 0.2)


def counts(
    conflicts: np.ndarray, walks: np.ndarray, names: Sequence[str] = NAMES, seeds: Sequence[int] | None = None
) -> Counts:
    """Return what runs of an hour counted."""
    shape = conflicts.shape
    each: Mapping[str, np.ndarray] = {
        **dict.fromkeys(
            (
                *("severe", "yields", "yieldable", "vehicle_speed_sum_mps", "ped_delay_sum_s"),
                *("p_fatal_sum", "p_fatal_squares", "n_p_fatal_defined"),
            ),
            np.zeros(shape),
        ),
        "conflicts": conflicts,
        "n_pedestrians": walks,
        "n_ped_delay_defined": walks,
        "n_vehicles": np.zeros(shape),
        "observed_s": np.full(shape, 3600.0),
    }
    known = [{"crossing_id": name} for name in names]
    return Counts(known, list(seeds or range(1, shape[1] + 1)), each, [], [], {})


def simulated(seed: int, rates: np.ndarray, names: Sequence[str] = NAMES) -> Counts:
    """Return counts with these conflicts for each pedestrian."""
    rng = np.random.default_rng(seed)
    walks = rng.poisson(WALKS, (len(rates), RUNS)).astype(np.float64)
    return counts(rng.poisson(rates[:, None] * walks).astype(np.float64), walks, names)


def changed(rows: Sequence[Row], metric: str = "conflicts_per_1000_ped") -> list[str]:
    """Return the crossings that changed."""
    return [row["crossing_id"] for row in rows if row["changed"] and row["metric"] == metric]


@pytest.mark.long
def test_the_crossing_that_became_safer_is_found_and_hardly_another() -> None:
    safer = RATES.copy()
    safer[7] *= 0.1
    found = [
        changed(change_rows(simulated(seed, RATES), simulated(1000 + seed, safer))) for seed in range(50)
    ]
    assert sum(NAMES[7] in names for names in found) >= 45
    others = sum(len({*names} - {NAMES[7], TOTAL}) for names in found)
    assert others <= 0.05 * 50 * len(NAMES)


def test_where_nothing_changed_hardly_a_crossing_is_called_changed() -> None:
    found = [
        changed(change_rows(simulated(seed, RATES), simulated(1000 + seed, RATES))) for seed in range(50)
    ]
    assert sum(len({*names} - {TOTAL}) for names in found) <= 0.05 * 50 * len(NAMES)


def test_a_small_p_value_is_not_written_as_0(tmp_path: Path) -> None:
    walks = np.full((2, RUNS), 1000.0)
    conflicts = np.arange(2.0 * RUNS).reshape(2, RUNS) % 3.0
    changed = write_changes(
        tmp_path, counts(conflicts, walks, NAMES[:2]), counts(900.0 - 2.0 * conflicts, walks, NAMES[:2])
    )
    written = read_csv(tmp_path / CHANGES.file)
    p_values = [(row["p_value"], texts["p_value"]) for row, texts in zip(changed.rows, written, strict=True)]
    small = [float(cell) / p for p, cell in p_values if p is not None and 0.0 < p < 5e-7]
    assert small
    assert small == pytest.approx([1.0] * len(small), rel=1e-5)


def test_differences_are_those_of_ratios_of_sums() -> None:
    base = counts(np.array([[1.0, 3.0], [0.0, 2.0]]), np.array([[10.0, 30.0], [20.0, 20.0]]), NAMES[:2])
    alt = counts(np.array([[2.0, 2.0], [4.0, 6.0]]), np.array([[10.0, 10.0], [20.0, 20.0]]), NAMES[:2])
    rows = {(row["crossing_id"], row["metric"]): row for row in change_rows(base, alt)}
    first = rows[NAMES[0], "conflicts_per_1000_ped"]
    assert (first["base_mean"], first["alt_mean"], first["diff_pct"]) == pytest.approx((100.0, 200.0, 100.0))
    total = rows[TOTAL, "conflicts_per_1000_ped"]
    assert (total["base_mean"], total["alt_mean"]) == pytest.approx((1000.0 * 6 / 80, 1000.0 * 14 / 60))
    # Two crossings are looked at for the same hour.
    assert rows[TOTAL, "conflicts_per_h"]["base_mean"] == pytest.approx(3.0)
    moved = rows[TOTAL, "pedestrians_per_h"]
    assert (moved["diff_mean"], moved["ci95_lo"] < -10.0 < moved["ci95_hi"]) == (pytest.approx(-10.0), True)
    undefined = rows[NAMES[0], "yield_rate"]
    assert (undefined["status"], undefined["base_mean"], undefined["p_value"]) == ("undefined", None, None)
    assert len(cells(CHANGES, list(rows.values()))) == len(rows)


def test_only_seeds_that_both_have_are_compared() -> None:
    base = counts(np.array([[1.0, 50.0, 3.0]]), np.full((1, 3), 10.0), NAMES[:1], [1, 2, 3])
    alt = counts(np.array([[3.0, 70.0, 1.0]]), np.full((1, 3), 10.0), NAMES[:1], [3, 4, 1])
    row = change_rows(base, alt)[0]
    assert (row["crossing_id"], row["n_pairs"]) == (TOTAL, 2)
    assert (row["base_mean"], row["alt_mean"]) == pytest.approx((200.0, 200.0))
    with pytest.raises(StudyError, match="no valid seed in common"):
        change_rows(base, counts(np.ones((1, 1)), np.ones((1, 1)), NAMES[:1], [9]))


def test_a_crossing_that_one_side_lacks_is_listed_and_not_compared() -> None:
    rows = change_rows(simulated(1, RATES[:2], NAMES[:2]), simulated(2, RATES[:2], NAMES[1:3]))
    status = {row["crossing_id"]: row["status"] for row in rows if row["metric"] == "pedestrians_per_h"}
    assert status == {TOTAL: "ok", NAMES[0]: "only_in_base", NAMES[1]: "ok", NAMES[2]: "only_in_alt"}
    with pytest.raises(StudyError, match="no crossing in common"):
        change_rows(simulated(1, RATES[:2], NAMES[:2]), simulated(2, RATES[:2], NAMES[2:4]))


def test_a_single_seed_gives_differences_without_intervals() -> None:
    row = change_rows(
        counts(np.ones((1, 1)), np.full((1, 1), 10.0), NAMES[:1]),
        counts(np.zeros((1, 1)), np.full((1, 1), 10.0), NAMES[:1]),
    )[0]
    assert (row["status"], row["diff_mean"], row["ci95_lo"], row["changed"]) == (
        "one_pair",
        -100.0,
        None,
        None,
    )
