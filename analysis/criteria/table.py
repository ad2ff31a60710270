"""All columns of criteria.csv, declared once."""

from __future__ import annotations

from analysis.tables.column import Column, Table

STATUSES = ("pass", "fail", "undefined", "invalid")


def _text(name: str, description: str, *choices: str, required: bool = False) -> Column:
    return Column(name, "string", "", description, choices=choices, required=required)


CRITERIA = Table(
    "criteria",
    "One row for each criterion and what it judges: an encounter, a run, a configuration",
    (
        _text("target", "folder of the target in the check's folder", required=True),
        _text("scenario_id", "scenario", required=True),
        _text("controller", "name of the controller", required=True),
        _text("configuration", "the same with the parameters that the study varies", required=True),
        _text(
            "scope",
            "what is judged; baseline: a configuration against the same one of an earlier check; "
            "case: a run by the rules of its test protocol",
            *("encounter", "run", "configuration", "baseline", "case"),
            required=True,
        ),
        _text("criterion_id", "criterion", required=True),
        _text("metric", "column of the scope's table", required=True),
        _text("statistic", "of a configuration"),
        _text("unit", "unit of value, threshold and margin"),
        _text("operator", "how the value has to be to the threshold", "<", "<=", ">", ">=", "=="),
        Column("threshold", "number", "as unit", "what the value is held against"),
        Column("value", "number", "as unit", "what was found; of a baseline row the difference, now − then"),
        Column("margin", "number", "as unit", "distance to the threshold, positive on the side that passes"),
        _text(
            "status",
            "undefined: there is no value; invalid: a run of it failed or is not valid",
            *STATUSES,
            required=True,
        ),
        Column("counts", "boolean", "1", "whether it decides the exit code", required=True),
        Column("seed", "integer", "1", "seed of the run"),
        _text("run", "folder of the run or of what it left, in the check's folder"),
        Column("encounter_id", "integer", "1", "number within the run", minimum=1.0),
        _text("ego_id", "ego of the encounter; of a failed run the ego that decides"),
        _text("ped_id", "pedestrian of the encounter"),
        Column("t_start_s", "number", "s", "beginning of the encounter"),
        Column("moment_s", "number", "s", "when what the criterion is about was worst"),
        _text("place", "where that was: the crossing, or who stood where"),
        Column("n_runs", "integer", "1", "valid runs of the configuration, or pairs with the baseline"),
        Column("p_holm", "number", "1", "corrected p of a comparison with the baseline", minimum=0.0),
        _text("colour", "band of a test protocol"),
        Column("points", "number", "1", "score of a test protocol"),
        _text("note", "why there is no value, what was compared, why a failure does not count"),
        _text("command", "makes the run again"),
    ),
    ("target", "scenario_id", "configuration", "scope", "criterion_id", "seed", "encounter_id"),
)
