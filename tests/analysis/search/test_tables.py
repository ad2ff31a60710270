"""The tables of a search, from trials written by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.files import read_csv
from analysis.search.axes import Axis
from analysis.search.kinds import kinds
from analysis.search.objective import Verdict
from analysis.search.results import KindRow, Tried, trial_margins, write_results

AXES = (Axis("gap_s", 0.0, 10.0),)
CONTACT = "no preventable contact"
FACTS = {"collision": "1", "impact_speed_kmh": "40", "impact_side": "front", "contact_place": "carriageway"}


def test_failures_are_those_that_failed_and_the_others_have_a_table_of_their_own(tmp_path: Path) -> None:
    tried = [
        Tried(1, 7, {"gap_s": 1.0}, Verdict(0.5, CONTACT)),
        Tried(2, 7, {"gap_s": 2.0}, Verdict(-0.5, CONTACT, FACTS)),
        Tried(3, 7, {"gap_s": 3.0}, Verdict(0.01, CONTACT, FACTS, unpreventable=True)),
        Tried(4, 7, {"gap_s": 4.0}, Verdict(None), invalid="a teleport"),
    ]
    assert [one.status for one in tried] == ["pass", "fail", "unpreventable", "invalid"]
    (kind,) = kinds(AXES, [tried[1].failure])
    write_results(tmp_path, AXES, tried, [KindRow(1, kind, "failures/1", "cosim run failures/1")], [])
    assert [row["status"] for row in read_csv(tmp_path / "trials.csv")] == [one.status for one in tried]
    (failed,) = read_csv(tmp_path / "failures.csv")
    assert (failed["trial"], failed["kind"], failed["gap_s"]) == ("2", "1", "2")
    (apart,) = read_csv(tmp_path / "unpreventable.csv")
    assert apart["trial"] == "3"


def test_a_trial_with_several_seeds_has_one_margin_the_mean_of_its_runs() -> None:
    tried = [
        Tried(1, 7, {"gap_s": 1.0}, Verdict(0.5, CONTACT), trial_margin=0.1),
        Tried(1, 8, {"gap_s": 1.0}, Verdict(-0.3, CONTACT, FACTS), trial_margin=0.1),
        Tried(2, 7, {"gap_s": 2.0}, Verdict(0.4, CONTACT), trial_margin=0.7),
        Tried(2, 8, {"gap_s": 2.0}, Verdict(None), invalid="a teleport", trial_margin=0.7),
        Tried(3, 7, {"gap_s": 3.0}, Verdict(None), trial_margin=1.0),
    ]
    points, margins = trial_margins(tried)
    assert points == [{"gap_s": 1.0}, {"gap_s": 2.0}]
    assert margins == [pytest.approx(0.1), 0.4]
