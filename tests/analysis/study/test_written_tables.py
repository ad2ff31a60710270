"""The files of a study: their bytes, their columns, their dictionary, and what they leave as it was."""

from __future__ import annotations

import csv
import json
import warnings
from pathlib import Path
from typing import Any

import pytest

from analysis.results.analyse import analyse_run
from analysis.study.tables import STUDY_TABLES
from analysis.study.writing import write_tables
from tests.analysis.recorded import Ego, Person, line, write_run
from tests.analysis.study.study_tables import only, read, tables

FILES = ("runs.csv", "encounters.csv", "configs.csv", "comparisons.csv", "datapackage.json")


@pytest.mark.long
def test_the_same_runs_give_the_same_bytes_in_any_order(folders: list[Path], tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    write_tables(one, folders, "sumo")
    write_tables(other, [folders[i] for i in (4, 1, 5, 0, 3, 2)], "sumo")
    for name in FILES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    write_tables(one, folders, "sumo")
    for name in FILES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    assert sorted(path.name for path in one.iterdir()) == sorted(FILES)


def test_wall_clock_times_are_in_no_table_but_that_of_the_runs(
    folders: list[Path], written: Path, tmp_path: Path
) -> None:
    for seed, folder in enumerate(folders):
        with (folder / "runs.csv").open(encoding="utf-8", newline="") as file:
            (row,) = csv.DictReader(file)
        row.update(wall_s=str(seed + 0.5), compute_p95_ms=str(seed))
        with (folder / "runs.csv").open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, row, lineterminator="\n")
            writer.writeheader()
            writer.writerow(row)
    write_tables(tmp_path / "two", folders, None)
    same = [name for name in FILES if name != "runs.csv"]
    assert [(written / n).read_bytes() for n in same] == [(tmp_path / "two" / n).read_bytes() for n in same]
    assert read(tmp_path / "two/runs.csv")[3]["wall_s"] != ""


@pytest.mark.parametrize("table", STUDY_TABLES, ids=lambda table: table.name)
def test_a_file_has_the_columns_of_the_schema_and_its_rows_are_sorted(written: Path, table: Any) -> None:
    with (written / table.file).open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert tuple(header) == table.names()
    keys = [tuple(row[header.index(name)] for name in table.key) for row in rows]
    assert len(set(keys)) == len(keys)
    if table.name == "runs":
        assert keys == sorted(keys)
    assert all(cell not in ("nan", "inf", "None", "True") for row in rows for cell in row)


@pytest.mark.long
def test_frictionless_finds_the_tables_of_analysed_runs_valid(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folders = []
    for seed in (1, 2, 3):
        for name, speed in (("sumo", 10.0), ("slow", 6.0)):
            run = write_run(
                tmp_path / "runs" / f"{name}-{seed}",
                [Ego(line(-20.0 - seed, 0, speed, 0))],
                [Person(line(32.5, -4, 0, 1.25)), Person(line(32.5, -5 - 0.1 * seed, 0, 1.2), name="b")],
                controller=name,
                config_id=f"{name}-0",
                seed=seed,
                run_id=f"{name}-{seed}",
            )
            analyse_run(run)
            folders.append(run)
    configs, comparisons = tables(tmp_path / "out", folders)
    assert only(configs, controller="sumo", metric="n_encounters")["mean"] == "2"
    assert only(comparisons, metric="ego_mean_speed_mps")["alt_mean"] == "6"
    assert only(comparisons, metric="ego_mean_speed_mps")["test"] == "sign"
    encounters = [row for folder in sorted(folders) for row in read(folder / "encounters.csv")]
    assert read(tmp_path / "out/encounters.csv") == sorted(
        encounters, key=lambda row: (row["config_id"], int(row["seed"]), int(row["encounter_id"]))
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its own dependencies warn on import
        import frictionless

        monkeypatch.chdir(tmp_path / "out")
        result = frictionless.Package("datapackage.json").validate()
        (tmp_path / "out/configs.csv").write_text(
            (tmp_path / "out/configs.csv").read_text().replace("partly_defined", "perhaps")
        )
        spoilt = frictionless.Package("datapackage.json").validate()
    assert result.valid, result.flatten(["type", "rowNumber", "fieldName", "message"])
    assert not spoilt.valid


def test_a_dictionary_that_is_there_keeps_what_else_it_describes(folders: list[Path], tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "datapackage.json").write_text(json.dumps({"resources": [{"name": "criteria"}, {"name": "runs"}]}))
    write_tables(out, folders, None)
    names = [one["name"] for one in json.loads((out / "datapackage.json").read_text())["resources"]]
    assert names == ["runs", "encounters", "configs", "comparisons", "criteria"]


def test_what_goes_wrong_while_writing_leaves_the_files_of_before(
    folders: list[Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    write_tables(out, folders, None)
    before = {name: (out / name).read_bytes() for name in FILES}
    (out / "comparisons.csv.part").mkdir()  # a name that cannot be written to
    with pytest.raises(OSError, match="comparisons"):
        write_tables(out, folders, None)
    assert {name: (out / name).read_bytes() for name in FILES} == before
