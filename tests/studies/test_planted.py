"""The town with a planted defect, and what is said of its screenings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analysis.errors import StudyError
from analysis.screening.ranking import BY_CONFLICTS, BY_RISK
from studies.planted.outcomes import RUNS, Replication, of_counts
from studies.planted.page import markdown, write_page
from studies.planted.town import DEFECTS, PLANTED, STREETS, Defect, crossing_of, write_town
from sumo_scenarios import library
from tests.analysis.screening.test_changes import counts

NAMES = [crossing_of(street) for street in range(1, STREETS + 1)]
FIRST = 9601


def screened(seed: int, factor: float, runs: int = 2 * RUNS) -> list[Replication]:
    """Return replications in which a planted crossing has so many times the others' rate."""
    rng = np.random.default_rng(seed)
    walks = np.full((STREETS, runs), 20.0)
    rates = np.full((STREETS, 1), 0.2)
    rates[PLANTED - 1] *= factor
    return list(
        of_counts(
            counts(rng.poisson(rates * walks).astype(np.float64), walks, NAMES, range(FIRST, FIRST + runs))
        )
    )


@pytest.mark.long
def test_a_much_worse_crossing_is_found_in_nearly_every_replication() -> None:
    found = [one for seed in range(20) for one in screened(seed, 4.0)]
    assert len(found) == 40
    assert sum(one.found for one in found) >= 38
    assert np.mean([one.rates for one in found], axis=0) == pytest.approx([0.8, 0.2], abs=0.03)
    assert {one.pedestrians for one in found} == {80.0}


@pytest.mark.long
def test_an_equal_crossing_is_found_as_seldom_as_any_other() -> None:
    found = [one for seed in range(20) for one in screened(seed, 1.0)]
    assert sum(one.found for one in found) <= 8, "a twentieth is expected"
    assert sum(one.called_worse + one.false_alarms for one in found) <= 0.05 * STREETS * len(found)


def test_a_replication_that_lacks_a_run_is_left_out() -> None:
    assert len(screened(1, 1.0, runs=2 * RUNS - 1)) == 1


def test_the_page_says_which_bars_are_met_and_what_was_not_run(tmp_path: Path) -> None:
    made = [screened(1, 8.0), screened(1, 8.0), *([] for _ in DEFECTS[2:])]
    told = markdown(
        {
            defect.name: {BY_RISK: some, BY_CONFLICTS: some[:1]}
            for defect, some in zip(DEFECTS, made, strict=True)
        }
    )
    by_risk, by_conflicts = told.split("### Ranked by conflicts alone")
    assert "1 of 1, 100%" in by_conflicts
    told = by_risk
    assert (
        f"- {DEFECTS[1].name}: first in at least 90% of replications: not decided by 2 of 45 replications."
        in told
    )
    assert f"- {DEFECTS[2].name}: not run." in told
    assert "2 of 2, 100% (16% … 100%)" in told
    with pytest.raises(StudyError, match="no finished replication"):
        write_page(tmp_path, tmp_path / "page.md")


@pytest.mark.sumo
@pytest.mark.parametrize("defect", [DEFECTS[2], DEFECTS[4]], ids=lambda defect: defect.name)
def test_the_town_has_twenty_crossings_of_which_one_is_another(defect: Defect, tmp_path: Path) -> None:
    town = library.load(str(write_town(defect, tmp_path / "town")))
    prepared = library.prepare(town, 1, tmp_path / "run")
    net = prepared.net_file.read_text("utf-8")
    assert [name for name in NAMES if f'"{name}"' in net] == NAMES
    assert net.count('function="crossing"') == STREETS
    if defect.signals:
        signals = (tmp_path / "town" / "signals.add.xml").read_text("utf-8")
        assert signals.count('duration="2" state="rrr"') == STREETS - 1
        assert signals.count('duration="1" state="yyr"') == 1
    else:
        edges = (tmp_path / "town" / "edges.edg.xml").read_text("utf-8")
        assert edges.count('speed="19.45"') == 4
        assert edges.count('speed="13.89"') == 4 * (STREETS - 1)
