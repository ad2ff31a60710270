"""Defines the columns of the tables over many runs: configs.csv and comparisons.csv."""

from __future__ import annotations

from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.tables.column import Column, Table

_KINDS = ("mean", "count", "yes_no", "share", "rate", "encounter")
_GROUPS = ("safety", "comfort", "pedestrians", "efficiency", "other")
_WORSE = ("higher", "lower", "neither")


def _text(name: str, description: str, *choices: str, required: bool = True) -> Column:
    return Column(name, "string", "", description, choices=choices, required=required)


def _count(name: str, description: str, required: bool = True) -> Column:
    return Column(name, "integer", "1", description, minimum=0.0, required=required)


def _value(name: str, description: str) -> Column:
    """Return a column of numbers in the unit of their row."""
    return Column(name, "number", "as unit", description)


def _number(name: str, unit: str, description: str) -> Column:
    return Column(name, "number", unit, description)


_SCENARIO = (
    _text("schema_version", "version of this table's schema"),
    _text("scenario_id", "scenario"),
)
_MEASURE = (
    _text("metric", "measure"),
    _text(
        "kind",
        "mean, count: one value for each run; yes_no: whether a run had one; share: events over trials and "
        "rate: events over exposure, summed over runs; encounter: one value for each encounter",
        *_KINDS,
    ),
    _text("unit", "unit of the values"),
    _text("group", "what it speaks of", *_GROUPS),
    Column("key", "boolean", "1", "one of the few measures that a claim may rest on", required=True),
    _text("worse", "which direction is worse", *_WORSE),
)

CONFIGS = Table(
    "configs",
    "One row for each configuration (controller, parameters, scenario, setting) and measure",
    (
        *_SCENARIO,
        _text("condition_id", "identity of scenario and setting, the same for all controllers"),
        _text("condition", "settings that the study varies in this scenario", required=False),
        _text("config_id", "controller, parameters, scenario and setting, without the seed"),
        _text("controller", "name of the controller"),
        _text("configuration", "the same with the parameters of it that the study varies"),
        *_MEASURE,
        _count("n_runs", "runs made"),
        _count("n_valid", "of them valid; the others count nowhere else in the row"),
        _count("n_defined", "valid runs with a value; the n of mean, sd and ci95"),
        _number("numerator", "1", "events; of an encounter row the encounters with a value"),
        _number("denominator", "as denominator_unit", "what they are counted over"),
        _text("denominator_unit", "unit of the denominator"),
        _value(
            "mean",
            "mean over runs; of a share or rate the ratio of the sums; of an encounter row the mean over all "
            "encounters, empty where some have no value",
        ),
        _value(
            "sd", "standard deviation between runs (of a share or rate: of the runs' contributions to it)"
        ),
        _value("sem", "sd over the square root of n_defined"),
        _value("ci95_lo", "95 % interval of the mean with the run as its unit, lower end"),
        _value("ci95_hi", "upper end"),
        _text("ci_method", "how", "t", "clopper_pearson", "poisson", "none"),
        _value("exact95_lo", "exact 95 % interval as if all events were independent, lower end"),
        _value("exact95_hi", "upper end"),
        _text("exact_method", "how", "clopper_pearson", "poisson", "none"),
        _value("upper95", "one-sided exact 95 % upper bound as if all events were independent"),
        _value("min", "smallest value, of runs or, in an encounter row, of encounters"),
        _value("p05", "5th percentile of them"),
        _value("median", "median of them"),
        _value("p95", "95th percentile of them"),
        _value("max", "largest of them"),
        _text("tail", "percentile in the bad direction, of encounter rows", "p05", "p95", required=False),
        _value("tail95_lo", "95 % interval of it by resampling runs, lower end"),
        _value("tail95_hi", "upper end"),
        _count("n_required_e10pct", "runs for an interval of 10 % of the mean either way", required=False),
        _count("n_more_e10pct", "of them still to be made", required=False),
        Column("enough_runs", "boolean", "1", "none is still to be made; empty where it cannot be said"),
        _text(
            "status",
            "why there is no mean, interval or number of runs; partly_defined: some encounters lack a value",
            "ok",
            "no_valid_run",
            "undefined",
            "one_run",
            "all_equal",
            "partly_defined",
        ),
    ),
    ("config_id", "metric", "kind"),
)

COMPARISONS = Table(
    "comparisons",
    "One row for each condition, pair of configurations and measure; runs are paired by seed",
    (
        *_SCENARIO,
        _text("condition_id", "identity of scenario and setting; all: over all conditions of the scenario"),
        _text("condition", "settings that the study varies in this scenario", required=False),
        _text("base", "configuration compared with"),
        _text("alt", "configuration that is compared"),
        *_MEASURE,
        _count("n_pairs", "seeds with a value on both sides"),
        _count("n_unpaired", "seeds with a run on one side only"),
        _count("n_invalid", "seeds lost because a run was not valid"),
        _count("n_undefined", "seeds lost because the measure is undefined in a run"),
        _value("base_mean", "mean or ratio of the base over the pairs"),
        _value("alt_mean", "mean or ratio of the alternative over the pairs"),
        _value("diff_mean", "alternative minus base"),
        _number("diff_pct", "%", "the same in percent of the base"),
        _value("sd_diff", "standard deviation of the pairs' differences"),
        _count(
            "n_required_d10pct",
            "seeds for an interval of the difference of 10 % of the base's mean either way",
            required=False,
        ),
        _value("ci95_lo", "95 % interval of the difference, lower end"),
        _value("ci95_hi", "upper end"),
        _text("ci_method", "how", "t", "agresti_min", "none"),
        _number("pair_corr", "1", "correlation of the pairs; at or below 0 common seeds have bought nothing"),
        _text("test", "test of no difference", "paired_t", "wilcoxon", "mcnemar", "sign", "none"),
        _number("statistic", "1", "its statistic"),
        Column("p_value", "number", "1", "its two-sided p", minimum=0.0),
        Column("p_holm", "number", "1", "p after Holm's correction over the family", minimum=0.0),
        _text("family", "tests that are corrected together, within one condition", "key", "other", "chosen"),
        _count("n_family", "how many they are"),
        Column("significant_05", "boolean", "1", "p_holm below 0.05; empty without a test"),
        _number("effect_size", "1", "size of the difference without unit"),
        _text("effect", "which one", "cohen_dz", "rank_biserial", required=False),
        _text(
            "verdict",
            "of the alternative, from p_holm and the interval; higher and lower where neither is worse",
            "better",
            "worse",
            "higher",
            "lower",
            "no_difference_shown",
        ),
        _text(
            "status",
            "why there is no test or interval",
            "ok",
            "no_pairs",
            "one_pair",
            "no_difference",
            "constant_difference",
        ),
    ),
    ("scenario_id", "condition_id", "base", "alt", "metric", "kind"),
)

STUDY_TABLES = (RUNS, ENCOUNTERS, CONFIGS, COMPARISONS)
"""The tables of a study."""
