"""References to cases wherever a scenario can be named: requests, studies, other machines, identities."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from cosim.batches.batch import BatchRequest, prepared
from cosim.batches.matrix import build_matrix
from cosim.batches.shipping import bundles
from cosim.batches.study import study_of
from cosim.errors import InputError
from cosim.running.compose import inputs_of
from cosim.running.request import RunRequest
from cosim.suites import judging
from sumo_scenarios.suites import build

CASE = "suite:fmvss127/obstructed_child_30kmh"


def study(**changes: object) -> dict[str, object]:
    return {"scenarios": [CASE], "controllers": ["aeb"], "seeds": [1], **changes}


def test_a_study_takes_cases_beside_scenarios_and_ships_no_files_for_them(tmp_path: Path) -> None:
    table = study_of(study(scenarios=[CASE, "midblock_zebra"]), "mine")
    matrix = build_matrix(table, tmp_path / "mine.toml")
    assert [one.place for one in matrix.configurations] == [CASE, "midblock_zebra"]
    assert matrix.jobs()[0].command().startswith(f"cosim run {CASE} ")
    assert "/" not in matrix.jobs()[0].name
    assert bundles(matrix.configurations) == ()


def test_an_unknown_case_of_a_study_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'obstructed_child_30kmh'"):
        build_matrix(study_of(study(scenarios=[f"{CASE}x"]), "mine"), tmp_path / "mine.toml")


@pytest.mark.parametrize(
    "changed",
    [
        {"start_distance_m": 4.5},
        {"overlap": 0.25},
        {"pedestrian_speed_kmh": 6.0},
        {"acceleration_distance_m": 1.2},
        {"obstructed": False},
    ],
)
def test_every_number_of_the_table_is_part_of_a_runs_identity(
    changed: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = inputs_of(RunRequest(CASE, "aeb")).run_id()
    assert inputs_of(RunRequest(CASE, "aeb")).run_id() == before
    (case,) = judging.cases(CASE)
    other = replace(case, group=case.group.model_copy(update=changed))
    monkeypatch.setattr(build, "find", lambda reference: other)
    assert inputs_of(RunRequest(CASE, "aeb")).run_id() != before


@pytest.mark.parametrize("speed", [20.0, 31.0])
def test_the_test_speed_is_part_of_a_runs_identity(speed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    (case,) = judging.cases("suite:fmvss127/stationary_30kmh")
    before = inputs_of(RunRequest(case.reference, "aeb")).run_id()
    monkeypatch.setattr(build, "find", lambda reference: replace(case, ego_speed_kmh=speed))
    assert inputs_of(RunRequest(case.reference, "aeb")).run_id() != before


@pytest.mark.sumo
def test_a_study_of_cases_lacks_a_run_for_each(tmp_path: Path) -> None:
    cases = [f"suite:fmvss127/stationary_{speed}kmh" for speed in (10, 20)]
    table = study_of(study(scenarios=cases), "mine")
    with prepared(BatchRequest(Path("mine.toml"), tmp_path / "mine", 1, table=table)) as batch:
        assert len(batch.missing) == 2
