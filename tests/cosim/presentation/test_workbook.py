"""The tables as an Excel workbook: each cell is that of the CSV file."""

from __future__ import annotations

import csv
from pathlib import Path

import openpyxl
import pytest

from analysis.study.runs import find_run_folders
from analysis.study.writing import write_tables
from cosim.cli import main
from cosim.errors import InputError
from cosim.presentation import workbook
from tests.analysis.study.study_folders import write_study_run


@pytest.fixture
def study(tmp_path: Path) -> Path:
    folder = tmp_path / "study"
    for seed in (1, 2):
        for name in ("sumo", "aeb"):
            met = [{"min_ttc_s": 1.25, "ego_id": "=1+1"}]
            write_study_run(folder / "runs" / f"{name}-{seed}", name, seed, encounters=met)
    write_tables(folder, find_run_folders(folder), None)
    return folder


def test_every_table_is_a_sheet_with_units_and_every_column_has_a_definition(
    study: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(study), "--xlsx"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(study / workbook.WORKBOOK)
    book = openpyxl.load_workbook(study / workbook.WORKBOOK)
    assert {"runs", "encounters", "configs", "comparisons", "definitions"} <= set(book.sheetnames)
    defined = {tuple(row[:2]) for row in book["definitions"].iter_rows(min_row=2, values_only=True)}
    for name in ("runs", "encounters", "configs", "comparisons"):
        with (study / f"{name}.csv").open(encoding="utf-8", newline="") as file:
            header, *rows = csv.reader(file)
        heads, *shown = book[name].iter_rows(values_only=True)
        assert [str(head).partition(" [")[0] for head in heads] == header
        assert {(name, column) for column in header} <= defined
        assert len(shown) == len(rows)
        for texts, values in zip(rows, shown, strict=True):
            for text, value in zip(texts, values, strict=True):
                if isinstance(value, bool):
                    assert text == str(int(value))
                elif isinstance(value, int | float):
                    assert float(text) == value
                else:
                    assert text.removeprefix("'") == (value or "")
    assert "min_ttc_s [s]" in [cell.value for cell in book["encounters"][1]]


@pytest.mark.long
def test_a_text_that_looks_like_a_formula_is_a_text(study: Path) -> None:
    workbook.write_workbook([study], study)
    sheet = openpyxl.load_workbook(study / workbook.WORKBOOK)["encounters"]
    column = [cell.value for cell in sheet[1]].index("ego_id") + 1
    cell = sheet.cell(2, column)
    assert (cell.value, cell.data_type) == ("=1+1", "s")


@pytest.mark.long
def test_the_same_tables_give_the_same_bytes(study: Path) -> None:
    first = workbook.write_workbook([study], study).read_bytes()
    assert workbook.write_workbook([study], study).read_bytes() == first


def test_a_folder_without_tables_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no table in"):
        workbook.write_workbook([tmp_path], tmp_path)
