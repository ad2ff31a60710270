"""What every metric has to be: described, declared, and tested with a value worked out by hand."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from analysis.encounters.case import Case, prepare
from analysis.errors import MetricError
from analysis.recording.reading import read_run
from analysis.results.metric_catalog import Metric, find_metrics, read_metric
from analysis.results.rows import measure
from analysis.tables.column import at_least_0, count
from tests.analysis.metrics.value_tests import compared, compared_in_rooms, complaint
from tests.analysis.recorded import Ego, Person, line, write_run

ROOT = Path(__file__).resolve().parents[3]
COMPARED = compared_in_rooms(ROOT)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    folder = tmp_path_factory.mktemp("run")
    return prepare(read_run(write_run(folder, [Ego(line(0, 0, 10, 0))], [Person(line(32.5, -5, 0, 1.25))])))


def file(**changes: Any) -> Any:
    """Return what a file of a metric of encounters has in it."""
    parts = {
        "__doc__": "Gap.\n\nUndefined: never.",
        "UNIT": "m",
        "WORSE": "lower",
        "SOURCE": "own definition",
        "COLUMNS": (at_least_0("gap_m", "m", "gap"),),
        "compute": lambda case: {"gap_m": np.zeros(len(case))},
        **changes,
    }
    return SimpleNamespace(**{name: part for name, part in parts.items() if part is not None})


@pytest.mark.parametrize("metric", find_metrics(), ids=lambda metric: metric.name)
def test_a_metric_says_what_it_is(metric: Metric) -> None:
    assert metric.worse in ("higher", "lower", "neither")
    title, blank, *rest = metric.text.splitlines()
    assert title.endswith(".") or not blank
    assert any(line.startswith("Undefined: ") for line in rest), "the rule for undefined is missing"
    columns = (*metric.columns, *metric.run_columns)
    assert metric.unit in {column.unit or "1" for column in columns}
    for column in columns:
        assert column.description, f"{column.name} has no meaning"
        assert not column.source, f"{column.name}: a metric returns its values itself"


@pytest.mark.parametrize("metric", find_metrics(), ids=lambda metric: metric.name)
def test_a_metric_has_a_test_with_a_value_worked_out_by_hand(metric: Metric) -> None:
    assert not complaint(metric, COMPARED)


def test_a_metric_without_such_a_test_is_told_what_to_write() -> None:
    metric = read_metric("gap", file())
    assert complaint(metric, compared('assert row["gap_m"] == 2.0')) == ""
    for source in ("", 'assert row["gap_m"] is not None', 'row["gap_m"] == 2.0'):
        assert "metric gap: in tests/analysis/metrics, record a ride" in complaint(metric, compared(source))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"SOURCE": None, "UNIT": None}, "no UNIT, no SOURCE"),
        ({"compute": None}, "no compute"),
        ({"COLUMNS": None}, "no COLUMNS or RUN_COLUMNS"),
        ({"RUN_COLUMNS": (count("n_gaps", "gaps"),)}, "no summarise"),
    ],
)
def test_a_file_that_lacks_something_is_refused_by_name(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(MetricError, match=f"metric gap: its file has {says}"):
        read_metric("gap", file(**changes))


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"gap_m": [1.0], "gap_s": [1.0]}, "its COLUMNS do not declare gap_s"),
        ({"gap_m": [1.0, 2.0]}, "2 values of gap_m for 1 encounters"),
    ],
)
def test_a_metric_that_returns_other_than_it_declares_is_named(
    case: Case, values: dict[str, Any], says: str
) -> None:
    with pytest.raises(MetricError, match=f"metric gap: {says}"):
        measure(read_metric("gap", file(compute=lambda case: values)), case)


def test_a_metric_that_summarises_what_it_does_not_declare_is_named(case: Case) -> None:
    metric = read_metric(
        "gap",
        file(RUN_COLUMNS=(count("n_gaps", "gaps"),), summarise=lambda case, columns: {"n_holes": 1}),
    )
    with pytest.raises(MetricError, match="metric gap: its RUN_COLUMNS do not declare n_holes"):
        measure(metric, case)


METRIC = '''
"""Gap: a metric that nobody has heard of.

Undefined: never.
"""

import numpy as np
from analysis.tables import column

UNIT = "m"
WORSE = "lower"
SOURCE = "own definition"
COLUMNS = (column.at_least_0("gap_m", "m", "how far apart"),)
RUN_COLUMNS = (column.at_least_0("gap_mean_m", "m", "mean of it"),)


def compute(case):
    return {"gap_m": np.full(len(case), 2.5)}


def summarise(case, columns):
    return {"gap_mean_m": np.mean(columns["gap_m"])}
'''
ANALYSIS = """
import sys
from pathlib import Path
from analysis import metrics
metrics.__path__.append(sys.argv[1])
from analysis.results.analyse import analyse_run
from analysis.results.measures import encounter_measures, run_measures
from analysis.metrics_page import render
report = analyse_run(Path(sys.argv[2]))
assert report.encounters[0]["gap_m"] == report.run["gap_mean_m"] == 2.5
assert "how far apart" in (report.folder / "datapackage.json").read_text()
assert {"gap_m", "gap_mean_m"} <= {one.name for one in (*encounter_measures(), *run_measures())}
assert "| `gap_mean_m` | number | m | mean of it |" in render()
"""


@pytest.mark.long
def test_one_file_is_all_that_a_metric_needs(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "run", [Ego(line(0, 0, 10, 0))], [Person(line(32.5, -5, 0, 1.25))])
    (tmp_path / "files").mkdir()
    (tmp_path / "files" / "unheard_of.py").write_text(METRIC)
    command = [sys.executable, "-c", ANALYSIS, str(tmp_path / "files"), str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    for name in ("encounters.csv", "runs.csv"):
        header, first, *_ = (folder / name).read_text().splitlines()
        assert header.endswith(("gap_m", "gap_mean_m"))
        assert first.endswith(",2.5")
