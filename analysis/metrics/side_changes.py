"""Changes of the passing class: from passing behind a pedestrian to passing ahead, or back.

The `passing` column names who is let pass and who is not: `behind=p1|p2 ahead=p3`. A change is counted when a
pedestrian's side differs from the last plan of the same ego that named them. For an encounter: until the ego
has left the conflict area.

Undefined: never; 0 for controllers without passing classes.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
OF_CONTROLLER = True
COLUMNS = (column.count("side_changes", "changes of the passing class", required=True),)
RUN_COLUMNS = (column.count("side_changes", "changes of the passing class", required=True),)


def compute(case: Case) -> Values:
    """Return the number of changes in each encounter."""
    changes = _changes(case)
    rows = [[row for row, name in changes if name == one.person.name] for one in case.encounters]
    counts = [
        int(np.isin(changed, ego_rows).sum()) for changed, ego_rows in zip(rows, case.ego_rows, strict=True)
    ]
    return {"side_changes": np.array(counts, dtype=np.int64)}


def collect_rides(case: Case) -> Values:
    """Return every change of the egos of a part of the run."""
    return {"changes": _changes(case)}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of changes in the run."""
    return {"side_changes": len(columns["changes"])}


def sides(text: str) -> dict[str, str]:
    """Return pedestrian -> side of a passing class.

    >>> sides("behind=a|b ahead=c")
    {'a': 'behind', 'b': 'behind', 'c': 'ahead'}
    """
    parts = (part.partition("=") for part in text.split())
    return {name: side for side, _, names in parts for name in names.split("|") if name}


def _changes(case: Case) -> list[tuple[int, str]]:
    """Return the row of the ego and the name of the pedestrian for every change."""
    passing = case.run.egos.texts["passing"]
    planned = case.run.egos.flags["planned"]
    by_code = [sides(text) for text in passing.names]
    found: list[tuple[int, str]] = []
    for track in case.egos:
        rows = track.rows[:: case.grid.factor]
        last: dict[str, str] = {}
        for row in rows[planned[rows]]:
            code = passing.codes[row]
            if code < 0 or code >= len(by_code):
                continue
            now = by_code[code]
            found += [(int(row), name) for name, side in now.items() if last.get(name, side) != side]
            last |= now
    return found
