"""Changes of the passing class: from passing behind a pedestrian to passing ahead, or back.

Counted between consecutive plans about the same number of pedestrians whose classes differ, such as
`behind:1 ahead:1` after `behind:2`. A plan about more or fewer pedestrians starts afresh.

Undefined: never; 0 for controllers without passing classes.
"""

from __future__ import annotations

import re

import numpy as np

from analysis.case import Case, Values

SCOPE = "encounter"
UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
COLUMNS = ("side_changes",)
RUN_COLUMNS = ("side_changes",)

_COUNT = re.compile(r"(behind|ahead):(\d+)")


def compute(case: Case) -> Values:
    """Return the number of changes in each encounter."""
    changed = _changes(case)
    return {
        "side_changes": np.array([int(changed[rows[1:]].sum()) for rows in case.ego_rows], dtype=np.int64)
    }


def summarise(case: Case, columns: Values) -> Values:
    """Return the number of changes in the run."""
    return {"side_changes": int(_changes(case).sum())}


def _changes(case: Case) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return the rows of the egos at which the class differs from the plan before."""
    passing = case.run.egos.texts["passing"]
    behind = np.zeros(len(passing.names) + 1, dtype=np.int64)
    total = np.zeros(len(passing.names) + 1, dtype=np.int64)
    for code, text in enumerate(passing.names):
        counts = {side: int(number) for side, number in _COUNT.findall(text)}
        behind[code] = counts.get("behind", 0)
        total[code] = sum(counts.values())
    changed = np.zeros(len(case.run.egos), dtype=np.bool_)
    planned = case.run.egos.flags["planned"]
    for track in case.egos:
        rows = track.rows[:: case.grid.factor]
        rows = rows[planned[rows]]
        codes = passing.codes[rows]
        same = total[codes[1:]] == total[codes[:-1]]
        changed[rows[1:]] = same & (behind[codes[1:]] != behind[codes[:-1]])
    return changed
