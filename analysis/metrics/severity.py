"""Severity of the encounter: collision, severe, serious, slight or none.

collision: contact with a moving ego. severe, serious, slight: smallest TTC or PET below the
severity_..._severe_s, _serious_s, _slight_s thresholds. none: everything else, and all persons who
wait at the kerb and never enter.

Undefined: never. The scale is a proposal; such measures serve to compare alternatives, their relation
to crashes is weak.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.encounters.severity_scale import LEVELS, severity_levels
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "limits after [Hayward1972], [SSAM2008] and the review [CriticalityMetrics]"
COLUMNS = (column.text("severity", "level of the encounter", *LEVELS[::-1], required=True),)
RUN_COLUMNS = (
    column.count("n_severity_none", "encounters without severity", required=True, worse="neither"),
    column.count("n_severity_slight", "slight encounters", required=True, worse="neither"),
    column.count("n_severity_serious", "serious encounters", required=True),
    column.count("n_severity_severe", "severe encounters", required=True),
)


def compute(case: Case) -> Values:
    """Return the level of each encounter."""
    return {"severity": severity_levels(case)}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count encounters by level."""
    found = list(columns["severity"])
    return {f"n_severity_{level}": found.count(level) for level in LEVELS if level != "collision"}
