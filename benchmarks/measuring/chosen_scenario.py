"""A scenario with parameters, from the words of a command line."""

from __future__ import annotations

import argparse
import sys

from cosim.errors import InputError
from cosim.running.request import parse_settings
from sumo_scenarios.library import ScenarioError, load, with_parameters
from sumo_scenarios.model import Scenario


def arguments(parser: argparse.ArgumentParser) -> None:
    """Let a command line name the scenario."""
    parser.add_argument("scenario")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")


def chosen(given: argparse.Namespace) -> Scenario | None:
    """Return the scenario; ``None`` after it was said what is wrong."""
    try:
        texts = parse_settings(given.set)
        scenario, leftover = with_parameters(load(given.scenario), texts)
        if leftover:
            raise ScenarioError(f"unknown parameter: {', '.join(leftover)}")
    except (InputError, ScenarioError) as error:
        print(error, file=sys.stderr)
        return None
    return scenario
