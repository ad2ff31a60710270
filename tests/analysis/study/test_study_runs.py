"""The run folders that a study is made of: found, left out, or refused."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from analysis.errors import StudyError
from analysis.study.runs import find_run_folders, read_runs
from analysis.study.writing import write_tables
from tests.analysis.study.study_folders import write_study_run

FILES = ("runs.csv", "encounters.csv", "configs.csv", "comparisons.csv", "datapackage.json")


@pytest.mark.long
def test_a_run_that_cannot_be_read_is_left_out_and_named(folders: list[Path], tmp_path: Path) -> None:
    write_tables(tmp_path / "without", folders[1:], None)
    for damage in ("[]", '{"seed": "one"}', "{"):
        (folders[0] / "run.json").write_text(damage)
        unreadable = write_tables(tmp_path / "out", folders, None)
        assert list(unreadable) == [folders[0]]
        assert str(folders[0] / "run.json") in unreadable[folders[0]]
        for name in FILES:
            assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "without" / name).read_bytes()
    with pytest.raises(StudyError, match=r"run\.json"):
        write_tables(tmp_path / "out", folders[:1], None)


def test_the_same_run_twice_counts_once(folders: list[Path], tmp_path: Path) -> None:
    again = shutil.copytree(folders[0], tmp_path / "runs/again")
    assert len(read_runs([*folders, again])) == 6


def test_a_run_that_was_made_again_takes_the_place_of_the_failed_one(
    folders: list[Path], tmp_path: Path
) -> None:
    failed = write_study_run(tmp_path / "runs/attempt", "sumo", 1, invalid="killed", analysed=False)
    runs = read_runs([failed, *folders])
    assert len(runs) == 6
    assert all(run.valid for run in runs)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"numbers": {"ego_delay_mean_s": 11.0}}, "two runs of"),
        ({"run_id": "other-version"}, "two runs of"),
    ],
)
def test_two_runs_of_a_seed_that_differ_are_refused(
    folders: list[Path], tmp_path: Path, change: dict[str, Any], says: str
) -> None:
    other = write_study_run(tmp_path / "runs/other", "sumo", 1, **change)
    with pytest.raises(StudyError, match=says) as caught:
        read_runs([*folders, other])
    assert str(other) in str(caught.value)
    assert str(folders[0]) in str(caught.value)


def test_runs_analysed_with_different_thresholds_are_refused(folders: list[Path], tmp_path: Path) -> None:
    other = write_study_run(tmp_path / "runs/other", "sumo", 9, thresholds={"hard_brake_mps2": 3.0})
    with pytest.raises(StudyError, match="different thresholds"):
        read_runs([*folders, other])


def test_a_valid_run_without_numbers_has_to_be_analysed(tmp_path: Path) -> None:
    folder = write_study_run(tmp_path, "sumo", 1, analysed=False)
    with pytest.raises(StudyError, match="cosim analyse"):
        read_runs([folder])


@pytest.mark.parametrize(
    ("file", "text", "says"),
    [
        ("run.json", "{", "not JSON"),
        ("run.json", "{}", "no value for 'run_id'"),
        ("run.json", "[]", "expected an object, found list"),
        ("runs.csv", "run_id\n1\n", "one row with the columns of schema"),
        ("runs.csv", "", "one row with the columns of schema"),
        ("encounters.csv", "run_id\n1\n", "expected the columns of schema"),
        ("encounters.csv", "", "expected the columns of schema"),
        ("config.json", "{", "cannot be read"),
    ],
)
def test_a_broken_file_is_named_in_one_line(tmp_path: Path, file: str, text: str, says: str) -> None:
    folder = write_study_run(tmp_path / "run", "sumo", 1)
    (folder / file).write_text(text)
    with pytest.raises(StudyError, match=says) as caught:
        read_runs([folder])
    assert str(folder / file) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_run_folders_are_found_at_any_depth_but_not_in_unfinished_ones(tmp_path: Path) -> None:
    wanted = [tmp_path / "b/run", tmp_path / "a/deep/er"]
    for folder in (*wanted, tmp_path / ".hidden/run", tmp_path / "half.part", tmp_path / "a/x.tmp/run"):
        write_study_run(folder, "sumo", 1)
    write_study_run(tmp_path / "b/run/inside", "sumo", 1)
    assert find_run_folders(tmp_path) == sorted(wanted)
    assert find_run_folders(wanted[0]) == wanted[:1]
