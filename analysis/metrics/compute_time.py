"""Wall-clock time of a control step: decide and plan.

Percentiles over all plans of all egos, from timing.parquet.

Undefined: empty without plans. Not reproducible: wall-clock time.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "ms"
WORSE = "higher"
SOURCE = "own definition"
RUN_COLUMNS = (
    column.at_least_0("compute_p50_ms", "ms", "median wall-clock time of a control step"),
    column.at_least_0("compute_p95_ms", "ms", "95th percentile of it"),
    column.at_least_0("compute_p99_ms", "ms", "99th percentile of it"),
)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return median, 95th and 99th percentile."""
    spent = whole.run.timing.numbers["compute_ms"]
    if len(spent) == 0:
        return {}
    return {f"compute_p{p}_ms": float(np.percentile(spent, p)) for p in (50, 95, 99)}
