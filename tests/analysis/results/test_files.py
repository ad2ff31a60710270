"""The files of a report: schema, data dictionary, determinism, thresholds and the metrics page."""

from __future__ import annotations

import csv
import json
import re
import shutil
import warnings
from pathlib import Path

import pytest

from analysis import metrics_page
from analysis.errors import ThresholdError
from analysis.results.analyse import RunReport, analyse_run
from analysis.results.metric_catalog import find_metrics
from analysis.results.run_tables import ENCOUNTERS, RUN_TABLES, RUNS
from analysis.tables.column import Table
from analysis.thresholds import Thresholds, names, with_settings
from tests.analysis.recorded import Ego, Person, Vehicle, line, write_run

ROOT = Path(__file__).resolve().parents[3]
FILES = (
    "encounters.csv",
    "runs.csv",
    "vehicle_overlaps.csv",
    "vehicle_conflicts.csv",
    "config.json",
    "datapackage.json",
)


def busy_run(folder: Path) -> Path:
    """Write a run with two collisions, a near miss, a kerb-stander and an overlap with a vehicle."""
    egos = [Ego(line(-21.2, 0, 10, 0), name="near"), Ego(line(0, 0, 10, 0), name="hit")]
    persons = [
        Person(line(32.5, -4, 0, 1.25), name="first"),
        Person(line(32.5, -5, 0, 1.25), name="second"),
        Person(line(32.5, -6, 0, 0), name="stander", phase=lambda t: "waiting"),
    ]
    return write_run(folder, egos, persons, [Vehicle(line(40, 0.5, 5, 0))])


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> RunReport:
    return analyse_run(busy_run(tmp_path_factory.mktemp("busy")))


def read(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("table", RUN_TABLES, ids=lambda table: table.name)
def test_a_file_has_the_columns_of_the_schema_in_order(report: RunReport, table: Table) -> None:
    with (report.folder / table.file).open(encoding="utf-8", newline="") as file:
        assert tuple(next(csv.reader(file))) == table.names()
    assert read(report.folder / table.file)


def test_undefined_values_are_empty_cells_and_booleans_are_0_or_1(report: RunReport) -> None:
    for table in RUN_TABLES:
        for row in read(report.folder / table.file):
            for column in table.columns:
                assert row[column.name] not in ("nan", "inf", "-inf", "None", "True", "False")
                if column.kind == "boolean":
                    assert row[column.name] in ("", "0", "1")


@pytest.mark.long
def test_frictionless_finds_the_data_package_valid(
    report: RunReport, monkeypatch: pytest.MonkeyPatch
) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its own dependencies warn on import
        import frictionless

        monkeypatch.chdir(report.folder)
        result = frictionless.Package("datapackage.json").validate()
    assert result.valid, result.flatten(["type", "rowNumber", "fieldName", "message"])


@pytest.mark.long
def test_frictionless_finds_a_wrong_cell(
    report: RunReport, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = shutil.copytree(report.folder, tmp_path / "copy")
    text = (folder / "encounters.csv").read_text()
    (folder / "encounters.csv").write_text(text.replace(",collision,", ",scratch,"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import frictionless

        monkeypatch.chdir(folder)
        assert not frictionless.Package("datapackage.json").validate().valid


def test_the_same_recording_gives_the_same_bytes(report: RunReport) -> None:
    before = {name: (report.folder / name).read_bytes() for name in FILES}
    analyse_run(report.folder)
    assert {name: (report.folder / name).read_bytes() for name in FILES} == before
    assert not list(report.folder.glob("*.part"))


def test_a_report_holds_what_the_files_say(report: RunReport) -> None:
    (row,) = read(report.folder / "runs.csv")
    assert int(row["n_encounters"]) == report.run["n_encounters"] == len(report.encounters)
    assert int(row["n_collisions"]) == report.run["n_collisions"] == 2
    severities = [str(one["severity"]) for one in report.encounters]
    assert severities.count("none") == int(row["n_severity_none"])
    assert {path.name for path in report.files} == set(FILES)


def test_wall_clock_values_are_told_apart_by_name(tmp_path: Path) -> None:
    folders = [busy_run(tmp_path / name) for name in ("one", "two")]
    path = folders[1] / "run.json"
    late = {**json.loads(path.read_text()), "wall_s": 7.0, "start_utc": "2027-01-01T00:00:00+00:00"}
    path.write_text(json.dumps(late))
    rows = [read(analyse_run(folder).folder / "runs.csv")[0] for folder in folders]
    different = {name for name in rows[0] if rows[0][name] != rows[1][name]}
    assert different == {"wall_s", "wall_rtf", "wall_start_utc"}


def test_every_threshold_and_curve_is_echoed(tmp_path: Path) -> None:
    folder = busy_run(tmp_path)
    analyse_run(folder, with_settings({"severity_ttc_serious_s": "1.2"}))
    config = json.loads((folder / "config.json").read_text())
    assert config["thresholds"] == {**Thresholds().as_dict(), "severity_ttc_serious_s": 1.2}
    assert config["pedestrian_radius_m"] == [0.25]
    assert set(config["injury_curves"]) == {"p_fatal_rosen2009", "p_mais3_mm2025"}


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("severity_ttc_serius_s", "1", "severity_ttc_serious_s"),
        ("mdrac_reaction_s", "soon", "expected a number"),
        ("mdrac_reaction_s", "nan", "a finite number"),
        ("substep_s", "0", "above 0"),
    ],
)
def test_a_wrong_threshold_is_refused_with_one_line(name: str, value: str, says: str) -> None:
    with pytest.raises(ThresholdError, match=re.escape(says)) as caught:
        with_settings({name: value})
    assert "\n" not in str(caught.value)


def test_every_column_that_is_no_description_comes_from_exactly_one_metric(report: RunReport) -> None:
    run_columns = [column.name for metric in find_metrics() for column in metric.run_columns]
    for table in RUN_TABLES:
        assert len(table.names()) == len(set(table.names()))
    assert set(report.encounters[0]) == set(ENCOUNTERS.names())
    assert set(report.run) <= set(RUNS.names())
    assert set(RUNS.names()) - set(report.run) <= set(run_columns), "no value and no metric"


def test_every_source_that_a_metric_names_is_in_the_references() -> None:
    listed = (ROOT / "docs/references.md").read_text("utf-8")
    for metric in find_metrics():
        for key in re.findall(r"\[([^\]]+)\]", metric.source):
            assert f"[{key}]" in listed, f"{metric.name}: [{key}]"


def test_the_metrics_page_is_current() -> None:
    assert (ROOT / "docs/metrics.md").read_text("utf-8") == metrics_page.render()


def test_every_threshold_is_used_by_some_file() -> None:
    sources = "".join(
        path.read_text("utf-8") for path in (ROOT / "analysis").rglob("*.py") if path.name != "thresholds.py"
    )
    assert [name for name in names() if f".{name}" not in sources] == []
