"""The network that a recorded run drove on."""

from __future__ import annotations

import hashlib
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from cosim.errors import InputError
from sumo_scenarios import library
from sumo_scenarios.suites.case import reference_of


def network_of(description: dict[str, Any]) -> Path:
    """Return the network file of a run of a built-in scenario or of a protocol's case.

    Parameters
    ----------
    description
        Content of ``run.json``.

    Raises
    ------
    InputError
        If the network cannot be found, or is not the one of the run.
    """
    name = reference_of(str(description["scenario_id"]))
    advice = "name the network with --network FILE.net.xml, or --no-road"
    try:
        with TemporaryDirectory(prefix="cosim-") as work:
            scenario = library.load(name)
            network = library.prepare(scenario, int(description["seed"]), Path(work)).net_file
            content = network.read_bytes()
    except (library.ScenarioError, OSError) as error:
        raise InputError(f"the network of {name} is not known ({error}): {advice}") from error
    if hashlib.sha256(content).hexdigest() not in description["inputs"].values():
        raise InputError(f"the network of {name} is not the one that the run drove on any more: {advice}")
    return network
