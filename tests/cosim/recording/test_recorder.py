"""What a run writes, read back."""

from __future__ import annotations

import json
import signal
from contextlib import closing
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from analysis.errors import RecordingError
from analysis.recording.columns import EGOS, NEIGHBOURS, PLANS, TIMING, RecordedColumn, RecordedTable
from analysis.recording.opening import opened_table
from cosim.errors import SimulationError
from cosim.recording import parquet_sink
from cosim.recording.parquet_sink import ParquetSink
from cosim.recording.recorder import Recorder
from cosim.running.simulation import keep_recorded
from cosim.step import loop
from tests.cosim.step.tiny_world import BODY, SteadyDriver, TinyWorld, without_planning

FILES = {table.file: table.schema for table in (EGOS, NEIGHBOURS, PLANS, TIMING)}


def record(folder: Path, world: TinyWorld) -> None:
    folder.mkdir(exist_ok=True)
    driver = SteadyDriver()
    with Recorder(folder) as recorder:
        loop.run(world, dict.fromkeys(world.names, driver), recorder)
        recorder.write_map(world.map_areas())


def test_every_file_has_the_columns_that_the_analysis_expects(tmp_path: Path) -> None:
    record(tmp_path, TinyWorld())
    for name, schema in FILES.items():
        assert pq.read_schema(tmp_path / name).equals(schema), name
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*FILES, "map.json"])


def test_a_column_that_is_declared_is_recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    front = RecordedColumn("to_front_m", "number", "m", "rear axle to front bumper", "truth.body.front")
    egos = RecordedTable(EGOS.name, EGOS.description, (*EGOS.columns, front), EGOS.key)
    monkeypatch.setattr("cosim.recording.recorder.EGOS", egos)
    record(tmp_path, TinyWorld())
    assert set(pq.read_table(tmp_path / egos.file)["to_front_m"].to_pylist()) == {BODY.front}


def test_a_number_that_is_not_finite_is_recorded_as_undefined(tmp_path: Path) -> None:
    world = TinyWorld()
    world.speed["ego"] = float("inf")
    with Recorder(tmp_path) as recorder:
        recorder.stepped(world.snapshot())
    assert pq.read_table(tmp_path / EGOS.file)["speed_mps"].to_pylist() == [None]


def test_an_ego_has_one_row_per_step_and_the_plan_in_the_steps_that_began_with_one(tmp_path: Path) -> None:
    record(tmp_path, TinyWorld(("a", "b"), steps=4, step=0.5))
    rows = pq.read_table(tmp_path / "egos.parquet").to_pylist()
    assert [(row["time_s"], row["ego_id"], row["planned"]) for row in rows] == [
        (0.5, "a", True),
        (0.5, "b", True),
        (1.0, "a", False),
        (1.0, "b", False),
        (1.5, "a", True),
        (1.5, "b", True),
        (2.0, "a", False),
        (2.0, "b", False),
    ]
    assert rows[0]["rule"] == "straight"
    assert rows[0]["because"] == "leader"
    assert rows[0]["gap_ahead_m"] == 12.5
    assert rows[0]["gap_behind_m"] is None
    assert rows[0]["slack_m"] == 0.0
    assert rows[2]["rule"] is None
    assert rows[2]["solved"] is None
    assert rows[0]["front_x_m"] == pytest.approx(5.25 + 3.55)


def test_persons_and_vehicles_have_one_row_each_per_step(tmp_path: Path) -> None:
    record(tmp_path, TinyWorld(steps=2))
    rows = pq.read_table(tmp_path / "neighbours.parquet").to_pylist()
    assert [row["object_kind"] for row in rows] == ["pedestrian", "vehicle"] * 2
    person, vehicle = rows[:2]
    assert (person["x_m"], person["width_m"], person["phase"]) == (30.0, 0.5, "walking")
    assert person["heading_rad"] == pytest.approx(np.pi / 2)
    assert person["crossing_id"] is None
    assert (vehicle["x_speed_mps"], vehicle["edge_or_lane"], vehicle["phase"]) == (9.0, "e_0", None)


def test_plans_are_kept_twice_a_second_in_world_coordinates(tmp_path: Path) -> None:
    record(tmp_path, TinyWorld(steps=40, step=0.05))
    rows = pq.read_table(tmp_path / "plans.parquet").to_pylist()
    assert [row["time_s"] for row in rows] == pytest.approx([0.0, 0.5, 1.0, 1.5])
    assert rows[0]["x_m"] == [1.0, 2.0]
    overlay = json.loads(rows[0]["overlay"])
    line = overlay.pop("reference_line_m")
    assert overlay == {"cone": [0.0, 1.0, None, 2.0]}
    assert np.diff(np.reshape(line, (-1, 2)), axis=0) == pytest.approx(np.array([[5.0, 0.0]] * 26))


def test_what_was_recorded_before_a_failure_is_kept(tmp_path: Path) -> None:
    with pytest.raises(SimulationError):
        record(tmp_path, TinyWorld(steps=10, breaks_at=7))
    assert pq.read_metadata(tmp_path / "egos.parquet").num_rows == 7
    assert not list(tmp_path.glob("*.part"))


def test_the_same_run_gives_the_same_bytes_apart_from_timing(tmp_path: Path) -> None:
    for name in ("first", "second"):
        record(tmp_path / name, TinyWorld(("a", "b"), steps=30))
    written = sorted((tmp_path / "first").iterdir())
    assert {path.name for path in written} == {*FILES, "map.json"}
    for path in written:
        same = path.read_bytes() == (tmp_path / "second" / path.name).read_bytes()
        assert same or path.name == "timing.parquet"


def test_an_empty_road_leaves_readable_files(tmp_path: Path) -> None:
    with Recorder(tmp_path) as recorder:
        recorder.stepped(without_planning(TinyWorld()))
    for name, schema in FILES.items():
        assert pq.read_table(tmp_path / name).schema.equals(schema)


def test_a_sink_writes_in_chunks_and_keeps_the_last_rows(tmp_path: Path) -> None:
    sink = ParquetSink(tmp_path / "timing.parquet", TIMING.schema, rows_per_chunk=4)
    for index in range(10):
        sink.add_row((float(index), "ego", 1.0))
    assert not (tmp_path / "timing.parquet").exists()
    sink.close()
    sink.close()
    written = pq.ParquetFile(tmp_path / "timing.parquet")
    assert written.metadata.num_rows == 10
    assert written.metadata.num_row_groups == 3


def test_an_interrupt_while_rows_are_written_loses_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    array, calls = parquet_sink._array, count()

    def disturbed(*arguments: Any) -> Any:
        if next(calls) == 4:
            signal.raise_signal(signal.SIGINT)
        return array(*arguments)

    monkeypatch.setattr(parquet_sink, "_array", disturbed)
    sink = ParquetSink(tmp_path / "timing.parquet", TIMING.schema, rows_per_chunk=64)
    added: list[float] = []

    def add_all() -> None:
        with closing(sink):
            for index in range(100):
                added.append(float(index))
                sink.add_row((float(index), "ego", 1.0))

    with pytest.raises(KeyboardInterrupt):
        add_all()
    assert 1 < len(added) < 100
    assert pq.read_table(tmp_path / "timing.parquet")["time_s"].to_pylist() == added


def full_sink(folder: Path) -> ParquetSink:
    sink = ParquetSink(folder / "timing.parquet", TIMING.schema, rows_per_chunk=64)
    for index in range(100):
        sink.add_row((float(index), "ego", 1.0))
    return sink


def test_a_table_that_lost_rows_on_its_way_is_not_given_its_name(tmp_path: Path) -> None:
    sink = full_sink(tmp_path)
    part = tmp_path / "timing.parquet.part"
    with part.open("rb+") as file:
        file.truncate(part.stat().st_size // 2)
    with pytest.raises(OSError, match="not complete"):
        sink.close()
    assert [path.name for path in tmp_path.iterdir()] == ["timing.parquet.part"]


def test_what_was_recorded_stays_where_no_file_can_be_made_of_it(tmp_path: Path) -> None:
    full_sink(tmp_path)
    part, blocked = tmp_path / "timing.parquet.part", tmp_path / "timing.parquet.new"
    before = part.read_bytes()
    blocked.mkdir()  # a name that cannot be written to
    (tmp_path / "run.json").write_text('{"seed": 1}')
    description = keep_recorded(tmp_path, "killed")
    assert part.read_bytes() == before
    assert f"killed; {part} could not be made a table" in description["invalid_reason"]
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *("files.json", "run.json", "timing.parquet.new", "timing.parquet.part"),
    ]


def test_every_page_of_a_table_has_a_checksum(tmp_path: Path) -> None:
    """In a folder without hashes: what was altered is refused, or nothing but a description of pages."""
    full_sink(tmp_path).close()
    path = tmp_path / "timing.parquet"
    content = path.read_bytes()
    true, refused = pq.read_table(path), 0
    for place in range(4, pq.read_metadata(path).row_group(0).total_byte_size + 4):
        altered = bytearray(content)
        altered[place] ^= 1
        path.write_bytes(altered)
        try:
            with opened_table(path) as file:
                assert file.read().equals(true), f"byte {place} was read as other data"
        except RecordingError:
            refused += 1
    assert refused > 100


def test_a_sink_refuses_rows_of_another_shape(tmp_path: Path) -> None:
    sink = ParquetSink(tmp_path / "timing.parquet", TIMING.schema)
    with pytest.raises(ValueError, match="expected 3 columns, got 2"):
        sink.add_row((0.0, "ego"))
    with pytest.raises(ValueError, match="columns of one length"):
        sink.add_columns([[0.0], ["ego", "ego"], [1.0]])
    sink.close()
