"""Ids that a spreadsheet would execute: harmless in every CSV file, and as they were where we read them."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.files import as_given, harmless, read_csv
from analysis.page.encounters import read_encounters
from analysis.page.tables import study_tables
from analysis.results.analyse import analyse_run
from analysis.study.design import read_study
from analysis.study.writing import write_tables
from tests.analysis.recorded import Ego, Person, line, write_run

PERSON = '=HYPERLINK("x";"y")'
EGO, SCENARIO = "@ego", "+1+cmd|' /C calc'!A0"


def recorded(folder: Path) -> Path:
    person = Person(line(32.5, -5.0, 0.0, 1.0), name=PERSON)
    write_run(folder, [Ego(line(0.0, 0.0, 8.0, 0.0), name=EGO)], [person], scenario_id=SCENARIO)
    analyse_run(folder)
    return folder


def raw_cells(path: Path) -> list[str]:
    with path.open(encoding="utf-8", newline="") as file:
        return [cell for row in csv.reader(file) for cell in row]


def test_no_cell_of_a_run_or_a_study_is_a_formula(tmp_path: Path) -> None:
    run = recorded(tmp_path / "runs" / "one")
    write_tables(tmp_path / "out", [run], None)
    files = [*run.glob("*.csv"), *(tmp_path / "out").glob("*.csv")]
    cells = [cell for path in files for cell in raw_cells(path)]
    begun = [cell for cell in cells if cell[:1] in set("=+-@\t\r\n")]
    assert all(float(cell) <= 0 for cell in begun), begun
    for text in (PERSON, EGO, SCENARIO):
        assert "'" + text in cells
    for name in ("runs.csv", "encounters.csv"):
        assert (tmp_path / "out" / name).read_bytes() == (run / name).read_bytes()


def test_our_own_readers_have_the_ids_of_the_recording(tmp_path: Path) -> None:
    run = recorded(tmp_path / "runs" / "one")
    row = read_csv(run / "encounters.csv")[0]
    assert (row["ego_id"], row["ped_id"], row["scenario_id"]) == (EGO, PERSON, SCENARIO)
    study = read_study([run])
    values = read_encounters(study).at(0).values
    assert {EGO, PERSON} <= set(values.values())
    write_tables(tmp_path, [run], None)
    tables = study_tables(study, tmp_path, tmp_path / "new", [run], None)
    assert tables.folder == tmp_path, "tables of these very runs are taken as they are"
    assert {one["scenario_id"] for one in tables.configs} == {SCENARIO}


@pytest.mark.long
@given(st.text() | st.from_regex(r"[-=+@\t'].*") | st.floats().map(str))
def test_a_text_comes_back_and_a_number_is_untouched(text: str) -> None:
    assert as_given(harmless(text)) == text
    assert harmless(text)[:1] not in set("=@\t\r\n＝＋－＠")


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_written_as_it_is(number: float) -> None:
    for text in (repr(number), f"{number:.6f}", f"{number:.6g}"):
        assert harmless(text) == text
