"""Recorded runs that cannot be judged are refused with one line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from analysis.errors import RecordingError
from analysis.recording.reading import read_run
from analysis.results.analyse import analyse_run
from tests.analysis.recorded import Ego, Person, line, write_run


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_run(
        tmp_path / "run", [Ego(line(-21.2, 0, 10, 0))], [Person(line(32.5, -4, 0, 1.25))], duration=6.0
    )


def change(folder: Path, file: str, edit: Callable[[pa.Table], pa.Table]) -> None:
    path = folder / file
    pq.write_table(edit(pq.read_table(path)), path)


def describe(folder: Path, **changes: Any) -> None:
    path = folder / "run.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))


def refusal(folder: Path) -> str:
    with pytest.raises(RecordingError) as caught:
        read_run(folder)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_a_folder_that_does_not_exist_is_named(tmp_path: Path) -> None:
    assert "no such run folder" in refusal(tmp_path / "nowhere")


def test_a_truncated_table_is_named(folder: Path) -> None:
    path = folder / "egos.parquet"
    path.write_bytes(path.read_bytes()[:-100])
    text = refusal(folder)
    assert "egos.parquet" in text
    assert "truncated" in text


def test_a_table_that_was_never_finished_says_so(folder: Path) -> None:
    (folder / "neighbours.parquet").rename(folder / "neighbours.parquet.part")
    assert "the run was cut off" in refusal(folder)


def test_a_truncated_description_is_named_with_line_and_column(folder: Path) -> None:
    path = folder / "run.json"
    path.write_text(path.read_text()[:40])
    text = refusal(folder)
    assert "run.json" in text
    assert "column" in text


def test_another_schema_version_is_refused(folder: Path) -> None:
    describe(folder, recording_schema_version="0")
    text = refusal(folder)
    assert "recording_schema_version is '0'" in text
    assert "reads '1'" in text


def test_a_description_without_a_needed_value_is_refused(folder: Path) -> None:
    describe(folder, run_id=None)
    assert "'run_id'" in refusal(folder)


@pytest.mark.parametrize("step", [0, -0.1, "fast"])
def test_a_step_that_is_no_positive_number_is_refused(folder: Path, step: object) -> None:
    describe(folder, step_s=step)
    assert "step_s" in refusal(folder)


def test_a_run_without_rows_is_refused(folder: Path) -> None:
    change(folder, "egos.parquet", lambda table: table.slice(0, 0))
    assert "egos.parquet: no rows" in refusal(folder)


def test_a_missing_column_is_named(folder: Path) -> None:
    change(folder, "neighbours.parquet", lambda table: table.drop_columns(["phase"]))
    text = refusal(folder)
    assert "neighbours.parquet" in text
    assert "no column 'phase'" in text


def test_a_recording_from_before_interventions_had_causes_can_be_read(folder: Path) -> None:
    change(folder, "egos.parquet", lambda table: table.drop_columns(["intervention_cause"]))
    causes = read_run(folder).egos.texts["intervention_cause"]
    assert (causes.codes == -1).all()


def test_a_column_of_another_type_is_named(folder: Path) -> None:
    def as_text(table: pa.Table) -> pa.Table:
        at = table.schema.get_field_index("speed_mps")
        return table.set_column(at, "speed_mps", pc.cast(table["speed_mps"], pa.string()))

    change(folder, "egos.parquet", as_text)
    assert "column 'speed_mps' is string, expected double" in refusal(folder)


def test_an_undefined_number_is_named_with_its_row(folder: Path) -> None:
    def without(table: pa.Table) -> pa.Table:
        values = table["front_x_m"].to_pylist()
        values[6] = None
        return table.set_column(table.schema.get_field_index("front_x_m"), "front_x_m", pa.array(values))

    change(folder, "egos.parquet", without)
    assert "column 'front_x_m', row 7" in refusal(folder)


@pytest.mark.parametrize("file", ["egos.parquet", "neighbours.parquet", "timing.parquet"])
def test_time_going_backwards_is_named_with_its_row(folder: Path, file: str) -> None:
    change(folder, file, lambda table: pa.concat_tables([table.slice(5), table.slice(0, 5)]))
    text = refusal(folder)
    assert file in text
    assert "'time_s', row 57: time goes backwards" in text


def test_two_rows_of_one_ego_at_one_instant_are_refused(folder: Path) -> None:
    def twice(table: pa.Table) -> pa.Table:
        return pa.concat_tables([table.slice(0, 4), table.slice(3)])

    change(folder, "egos.parquet", twice)
    assert "row 5: 'ego' has a second row" in refusal(folder)


@pytest.mark.parametrize("entry", [{}, {"name": "a", "kind": "lane", "width_m": 1, "shape_m": [1, 2]}, 3])
def test_a_broken_map_is_named(folder: Path, entry: object) -> None:
    (folder / "map.json").write_text(json.dumps({"areas": [entry]}))
    assert "map.json: area 1" in refusal(folder)


def test_a_refused_run_keeps_the_report_it_had(folder: Path) -> None:
    analyse_run(folder)
    before = (folder / "runs.csv").read_bytes()
    describe(folder, recording_schema_version="0")
    with pytest.raises(RecordingError):
        analyse_run(folder)
    assert (folder / "runs.csv").read_bytes() == before


def test_a_run_without_pedestrians_has_no_encounters_but_a_row(tmp_path: Path) -> None:
    report = analyse_run(write_run(tmp_path, [Ego(line(0, 0, 10, 0))], duration=2.0))
    assert report.encounters == []
    assert report.run["n_encounters"] == 0
    assert report.run["min_ttc_s"] is None


def test_an_ego_of_a_single_instant_is_analysed(tmp_path: Path) -> None:
    ego = Ego(line(0, 0, 10, 0), start=0.1, end=0.1)
    report = analyse_run(write_run(tmp_path, [ego], [Person(line(10, -3, 0, 1.25))], duration=2.0))
    assert report.run["ego_count"] == 1
    assert report.run["ego_mean_speed_mps"] is None


def test_a_person_who_is_missing_for_a_while_comes_back_as_another_encounter(folder: Path) -> None:
    def with_a_gap(table: pa.Table) -> pa.Table:
        return table.filter(pc.or_(pc.less(table["time_s"], 1.0), pc.greater(table["time_s"], 2.0)))

    change(folder, "neighbours.parquet", with_a_gap)
    assert analyse_run(folder).run["n_encounters"] == 2
