"""Delay of the egos against free flow.

The integral of dt − ds / limit over the ride, the speed limit taken with factor 1 for all controllers;
time driven faster than the limit counts as gained. ego_time_loss_s is the sum over all egos,
ego_delay_mean_s the mean for an ego.

Undefined: steps without a recorded limit do not count; empty where none has one.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "s"
WORSE = "higher"
SOURCE = "as SUMO's timeLoss, with speed factor 1"
RUN_COLUMNS = (
    column.number("ego_time_loss_s", "s", "delay of all egos against free flow"),
    column.number("ego_delay_mean_s", "s", "the same for an ego"),
)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return sum and mean over the egos."""
    limit = whole.run.egos.numbers["speed_limit_mps"]
    known = np.isfinite(limit) & (limit > 0.0)
    if not known.any():
        return {}
    lost = (whole.steps.duration - whole.steps.distance / np.where(known, limit, 1.0))[known].sum()
    egos = len(whole.egos)
    return {"ego_time_loss_s": float(lost), "ego_delay_mean_s": float(lost) / egos}
