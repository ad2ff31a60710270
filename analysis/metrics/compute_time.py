"""Wall-clock time of a control step: decide and plan.

Percentiles over all plans of all egos, from timing.parquet.

Undefined: empty without plans. Not reproducible: wall-clock time.
"""

from __future__ import annotations

import numpy as np

from analysis.case import Case, Values

SCOPE = "run"
UNIT = "ms"
WORSE = "higher"
SOURCE = "own definition"
COLUMNS = ()
RUN_COLUMNS = ("compute_p50_ms", "compute_p95_ms", "compute_p99_ms")


def compute(case: Case) -> Values:
    """Return median, 95th and 99th percentile."""
    spent = case.run.timing.numbers["compute_ms"]
    if len(spent) == 0:
        return {}
    return {f"compute_p{p}_ms": float(np.percentile(spent, p)) for p in (50, 95, 99)}
