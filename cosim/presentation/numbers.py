"""Short tables of the results of runs, read only from the CSV files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from rich import box
from rich.table import Table

from analysis.files import read_csv
from cosim.errors import SimulationError

Row = Mapping[str, str]

# Label, column of runs.csv, format; columns that an analysis does not write are left out.
_LINES = (
    ("egos", "ego_count", "{:.0f}"),
    ("encounters", "n_encounters", "{:.0f}"),
    ("entered encounters", "n_entered", "{:.0f}"),
    ("contacts", "n_collisions", "{:.0f}"),
    ("preventable contacts", "n_collisions_preventable", "{:.0f}"),
    ("contacts on a crossing", "n_collisions_crossing", "{:.0f}"),
    ("contacts on the carriageway", "n_collisions_carriageway", "{:.0f}"),
    ("contacts on a walking area or at the kerb", "n_collisions_walking_area_or_kerb", "{:.0f}"),
    ("contacts with a pedestrian who appeared suddenly", "n_collisions_class_appeared", "{:.0f}"),
    ("contacts with the standing ego", "n_contacts_standing", "{:.0f}"),
    ("minimum distance [m]", "min_dist_m", "{:.2f}"),
    ("clearance of the moving ego, 1st percentile [m]", "clearance_p01_m", "{:.2f}"),
    ("minimum time to collision (TTC) [s]", "min_ttc_s", "{:.2f}"),
    ("entered encounters with TTC < 1.5 s", "n_ttc_lt_1p5", "{:.0f}"),
    ("minimum post-encroachment time (PET) [s]", "min_pet_s", "{:.2f}"),
    ("passes within 0.5 m above 3 m/s", "n_close_passes", "{:.0f}"),
    ("largest deceleration [m/s²]", "max_decel_mps2", "{:.2f}"),
    ("95th percentile of jerk [m/s³]", "p95_abs_jerk_mps3", "{:.2f}"),
    ("mean delay of an ego against free flow [s]", "ego_delay_mean_s", "{:.1f}"),
    ("decisions: straight", "n_straight", "{:.0f}"),
    ("decisions: lane change", "n_lane_change", "{:.0f}"),
    ("decisions: autonomous", "n_autonomous", "{:.0f}"),
    ("completed lane changes", "n_lane_changes", "{:.0f}"),
    ("overlaps with vehicles", "n_vehicle_overlaps", "{:.0f}"),
    ("vehicle collisions caused by the ego", "n_vehicle_overlaps_ego_closed", "{:.0f}"),
    ("interventions by SUMO", "n_interventions", "{:.0f}"),
    ("unsolved steps", "n_solver_fail", "{:.0f}"),
    ("plans replaced by the last check", "n_shielded", "{:.0f}"),
    ("control step, median [ms]", "compute_p50_ms", "{:.2f}"),
    ("control step, 99th percentile [ms]", "compute_p99_ms", "{:.2f}"),
)


def read_row(folder: Path) -> Row:
    """Return the single row of ``runs.csv`` in a run's folder."""
    path = folder / "runs.csv"
    try:
        rows = read_csv(path)
    except OSError as error:
        raise SimulationError(f"{path} cannot be read: {error.strerror}") from error
    if len(rows) != 1:
        raise SimulationError(f"{path}: expected one row, found {len(rows)}")
    return rows[0]


def run_table(row: Row, extra: Sequence[tuple[str, str]] = ()) -> Table:
    """Return one run's numbers, one per line."""
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column()
    table.add_column(justify="right")
    for label, text in (*shown_rows(row).items(), *extra):
        table.add_row(label, text)
    return table


def shown_rows(row: Row) -> dict[str, str]:
    """Return one run's numbers as labels and texts."""
    return {label: _shown(row[column], layout) for label, column, layout in _LINES if column in row}


def comparison_table(
    rows: Mapping[str, Row], title: str, extra: Mapping[str, Sequence[str]] | None = None
) -> Table:
    """Return the numbers of several runs side by side, one column per run.

    ``extra`` holds further lines, one text per run.
    """
    table = Table(title=title, title_justify="left", title_style="", box=box.MARKDOWN)
    table.add_column("")
    for name in rows:
        table.add_column(name, justify="right")
    for label, column, layout in _LINES:
        if any(column in row for row in rows.values()):
            table.add_row(label, *(_shown(row.get(column, ""), layout) for row in rows.values()))
    for label, texts in (extra or {}).items():
        table.add_row(label, *texts)
    return table


def number(row: Row, column: str) -> float | None:
    """Return a value of the row; ``None`` if it is undefined or the column does not exist."""
    text = row.get(column, "")
    return float(text) if text else None


def _shown(text: str, layout: str) -> str:
    if text == "":
        return "–"
    try:
        return layout.format(float(text))
    except ValueError:
        return text
