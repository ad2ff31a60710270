"""Demand texts filled with a scenario's parameters."""

from __future__ import annotations

from pathlib import Path
from string import Template

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.model import Scenario
from sumo_scenarios.schema import ScenarioTable
from sumo_scenarios.xml_files import check_xml

# SUMO's exp(0) is not defined; at this rate the first arrival is expected after thirty years.
_NOBODY_PER_S = 1e-9
MOST_PER_HOUR = 100_000.0
"""Highest rate of a flow, which fifty lanes cannot take; SUMO would stall inserting more vehicles [1/h]."""


def placeholders(scenario: Scenario, table: ScenarioTable) -> dict[str, str]:
    """Return the values that demand texts can name, as texts: parameters, [rates] in 1/s and [times] in s."""
    per_hour = {
        "vehicles_per_hour": scenario.vehicles_per_hour,
        "pedestrians_per_hour": scenario.pedestrians_per_hour,
        **scenario.parameters,
    }
    values = {key: str(value) for key, value in per_hour.items() if value is not None}
    values["end_s"] = f"{scenario.begin_s + scenario.duration_s:.3f}"
    values["warmup_s"] = f"{scenario.warmup_s:.3f}"
    for name, rate in table.rates.items():
        count = per_hour.get(rate.of)
        if isinstance(count, bool) or not isinstance(count, int | float):
            raise ScenarioError(
                f"{scenario.name}: rates.{name}.of is {rate.of!r}, which is not a number per hour"
            )
        hourly = count * rate.share
        if not hourly <= MOST_PER_HOUR:
            raise ScenarioError(
                f"{scenario.name}: rates.{name} is {hourly:g} an hour; expected at most {MOST_PER_HOUR:g}"
            )
        values[name] = f"{max(hourly / 3600.0, _NOBODY_PER_S):.9f}"
    for name, after_warmup_s in table.times.items():
        values[name] = f"{max(scenario.warmup_s + after_warmup_s, 0.0):.3f}"
    return values


def fill(source: Path, values: dict[str, str], target: Path) -> None:
    """Write a demand text with its placeholders filled in.

    Raises
    ------
    ScenarioError
        If the source is missing, names a value that does not exist, or is not well-formed.
    """
    try:
        text = Template(source.read_text(encoding="utf-8")).substitute(values)
    except OSError as error:
        raise ScenarioError(f"{source}: cannot be read: {error.strerror}") from error
    except KeyError as error:
        exist = ", ".join(sorted(values))
        raise ScenarioError(f"{source}: names ${error.args[0]}; values that exist: {exist}") from None
    except ValueError as error:
        raise ScenarioError(f"{source}: {error}") from None
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text, encoding="utf-8", newline="\n")
    check_xml(target)
