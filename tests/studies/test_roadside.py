"""The tables of the roadside study, on runs that can be checked by hand; its study file is one that runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.errors import StudyError
from analysis.study.runs import find_run_folders, read_runs
from cosim.batches.matrix import build_matrix
from cosim.batches.study import read_study
from studies.roadside.cells import against, cells
from studies.roadside.page import write_page
from tests.analysis.study.study_folders import write_study_run

ROOT = Path(__file__).resolve().parents[2]
MET = {"visible_before_conflict_s": 2.0, "preventable_r157": 1}
TOUCHED = {
    **MET,
    "collision": True,
    "n_collisions": 1,
    "visible_before_conflict_s": 0.5,
    "preventable_r157": 0,
}


def _study(folder: Path) -> Path:
    onboard = {"hidden_by": "bus", "sensing": "onboard"}
    late = {"hidden_by": "bus", "sensing": "fused", "sensing.latency_ms": 500.0}
    soon = {**late, "sensing.latency_ms": 0.0}
    for seed, hits in ((1, 2), (2, 1)):
        runs = (
            ("o", onboard, [TOUCHED] * hits + [MET] * (4 - hits), 10.0),
            ("l", late, [{**TOUCHED, "preventable_r157": 1}] + [MET] * 3, 12.0 + seed),
            ("s", soon, [MET] * 4 + [{**MET, "entered": False}], 8.0),
        )
        for name, setting, encounters, delay in runs:
            for pace in (0.0, 1.5):
                write_study_run(
                    folder / f"{name}{seed}{pace}",
                    "vo_mpc",
                    seed,
                    setting=setting,
                    parameters={"hidden_speed_mps": pace},
                    numbers={"ego_delay_mean_s": delay},
                    encounters=encounters,
                )
    write_study_run(folder / "bad", "aeb", 1, setting=onboard, invalid="teleported", encounters=[TOUCHED])
    return folder


def test_a_cell_is_one_driver_with_one_sensing_and_latency(tmp_path: Path) -> None:
    found = cells(read_runs(find_run_folders(_study(tmp_path))))
    mine = [cell for cell in found if cell.driver == "vo_mpc, hidden_speed_mps = 1.5"]
    assert [cell.seeing for cell in mine] == [("onboard", None), ("fused", 0.0), ("fused", 500.0)]
    onboard, soon, late = mine
    assert (onboard.runs, onboard.encounters, onboard.contacts) == (2, 8, 3)
    assert (soon.encounters, soon.contacts) == (8, 0), "who does not enter is not met"
    assert sum(one.preventable for one in onboard.outcomes) == 0
    assert sum(one.preventable for one in late.outcomes) == 2
    (bad,) = (cell for cell in found if cell.driver == "aeb")
    assert (bad.runs, bad.outcomes) == (1, ())


def test_a_sensing_is_compared_with_onboard_seed_by_seed(tmp_path: Path) -> None:
    found = cells(read_runs(find_run_folders(_study(tmp_path))))
    onboard, soon, late = (cell for cell in found if cell.driver.endswith("1.5"))
    assert against(onboard, onboard, "delay") == ""
    # 3 and 4 s later: 3.5 ± 12.7 · 0.5, by Student's t of two.
    assert against(late, onboard, "delay") == "+3.50 (-2.85 … +9.85)"
    assert against(soon, onboard, "delay") == "-2.00"
    assert against(soon, onboard, "contacts").startswith("-0.38")


@pytest.mark.long
def test_the_page_keeps_what_stands_above_its_tables(tmp_path: Path) -> None:
    study, page = _study(tmp_path / "study"), tmp_path / "page.md"
    page.write_text("# Title\n\nWhat we read in it.\n\n## Tables\n\nstale numbers\n")
    write_page(study, page)
    first = page.read_text()
    assert first.startswith("# Title\n\nWhat we read in it.\n\n## Tables\n\n![")
    assert "stale" not in first
    assert "| onboard |  | 2 of 2 | 8 | **3** | 38% (9% … 76%) | 0 | 1.4 | 10.0 |  |  |" in first
    assert "| onboard |  | 0 of 1 | 0 | **0** |  | 0 |  |  |  |  |" in first
    picture = (tmp_path / "page.svg").read_bytes()
    write_page(study, page)
    assert page.read_text() == first
    assert (tmp_path / "page.svg").read_bytes() == picture
    with pytest.raises(StudyError, match="no runs"):
        write_page(tmp_path / "nothing", page)


def test_the_study_file_asks_for_every_sensing_and_multiplies_only_what_depends_on_it() -> None:
    file = ROOT / "studies/roadside/roadside.toml"
    matrix = build_matrix(read_study(file), file)
    asked = [(one.controller, one.sensing) for one in matrix.configurations]
    # Two things that hide; three latencies where there is radio; two paces for vo_mpc.
    expected = {"perfect": 2, "onboard": 2, "roadside": 6, "fused": 6}
    for model, number in expected.items():
        assert asked.count(("aeb", model)) == number
        assert asked.count(("vo_mpc", model)) == 2 * number
    assert min(matrix.seeds) >= 9301
