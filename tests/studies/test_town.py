"""The page of a screened town, of files made by hand."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from analysis.errors import StudyError
from analysis.files import write_csv
from analysis.screening.crossings_table import CROSSINGS
from studies.town.__main__ import SCREENING
from studies.town.page import write_page
from tests.analysis.recorded import ZEBRA

CELLS = {
    "length_m": "7",
    "observed_h": "0.2",
    "n_conflicts": "3",
    "n_severe": "1",
    "n_collisions": "1",
    "expected_conflicts_per_1000_ped": "42.4",
    "rank_by_conflicts": "2",
    "p_fatal_expected": "0.02",
    "risk_per_1000_ped": "0.848",
    "x_m": "32.5",
    "y_m": "0",
}


def test_the_page_says_what_it_took_and_which_crossings_are_worst(tmp_path: Path) -> None:
    out = tmp_path / "folder" / SCREENING
    run = out / "runs" / "one"
    run.mkdir(parents=True)
    lane = {"name": "e_0", "kind": "lane", "width_m": 3.2, "shape_m": [[0.0, 0.0], [60.0, 0.0]]}
    (run / "map.json").write_text(json.dumps({"areas": [ZEBRA, lane]}))
    (run / "run.json").write_text(json.dumps({"duration_s": 360.0, "wall_s": 20.0, "wall_total_s": 25.0}))
    (run / "traffic.parquet").write_bytes(bytes(1_000_000))
    rows = [
        {**CELLS, "crossing_id": ":a_c0", "rank": "1", "rank_lo": "1", "rank_hi": "2", "worse": "1"},
        {**CELLS, "crossing_id": ":b_c0", "n_conflicts": "0", "n_collisions": "0"},
    ]
    names = CROSSINGS.names()
    write_csv(out / CROSSINGS.file, names, [[row.get(name, "") for name in names] for row in rows])
    write_csv(out / "traffic_encounters.csv", ["run_id"], [["r"], ["r"]])
    page = tmp_path / "page.md"
    write_page(tmp_path / "folder", page)
    told = page.read_text("utf-8")
    for line in (
        "| simulated time that counts | 6 min in all |",
        "| wall time of the runs, one after the other | 25 s |",
        "| recording of everybody | 10 MB per simulated hour |",
        "| crossings | 2 |",
        "| ranked | 1 |",
        "| rows of traffic_encounters.csv | 2 |",
        "| conflicts | 3 |",
        "| 1 | 1–2 | 2 | `:a_c0` (worse) | 3 | 42 | 2.0% | 0.848 |",
    ):
        assert line in told
    assert page.with_suffix(".svg").is_file()


def test_a_folder_without_a_ranking_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="no ranking"):
        write_page(tmp_path, tmp_path / "page.md")
