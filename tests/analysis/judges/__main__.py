"""``python -m tests.analysis.judges`` prints the agreement table of docs/judges.md."""

from __future__ import annotations

from collections.abc import Callable

from analysis.markdown import table_of
from tests.analysis.judges.agreement import Agreement
from tests.analysis.judges.conflict_areas import conflict_area_instants
from tests.analysis.judges.recorded_rides import curved_rides
from tests.analysis.judges.uniform_motion import (
    braking,
    distance_between_samples,
    predicted_distance,
    rectangle_overlap,
    time_to_contact,
)

JUDGES: tuple[Callable[[], Agreement], ...] = (
    time_to_contact,
    predicted_distance,
    distance_between_samples,
    rectangle_overlap,
    braking,
    conflict_area_instants,
    lambda: curved_rides(0.1),
    lambda: curved_rides(1.0),
)


def main() -> None:
    """Print the table."""
    rows = [
        {
            "measure": found.measure,
            "judge": found.judge,
            "cases": found.cases,
            "compared": found.defined,
            "largest difference": f"{found.largest:.2g} {found.unit}",
            "mean difference": f"{found.mean:.2g} {found.unit}",
            "disagreements": found.disagreements,
        }
        for found in (judge() for judge in JUDGES)
    ]
    print(table_of(rows))


if __name__ == "__main__":
    main()
