"""Export of a SUMO network as OpenDRIVE with netconvert; coordinates stay the same."""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from pathlib import Path

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.file_names import plain_name
from sumo_scenarios.sumo_installation import netconvert, sumo_home

_COMMENT = re.compile(rb"<!--.*?-->\s*", re.DOTALL)
_DATE = re.compile(rb'(<header [^>]*?)\sdate="[^"]*"')


def write_opendrive(network: Path, target: Path) -> None:
    """Write a network as OpenDRIVE 1.4; the same network gives the same bytes.

    Raises
    ------
    ScenarioError
        If netconvert cannot read the network.
    OSError
        If the file cannot be written.
    """
    if not network.is_file():
        raise ScenarioError(f"{network}: there is no such network")
    with tempfile.TemporaryDirectory(prefix="cosim-") as work:
        raw = Path(work) / "raw.xodr"
        command = [str(netconvert()), "--sumo-net-file", plain_name(network, raw.parent)]
        command += ["--opendrive-output", str(raw)]
        environment = {**os.environ, "SUMO_HOME": str(sumo_home())}
        result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        if result.returncode != 0 or not raw.is_file():
            lines = [one for one in (result.stderr + result.stdout).splitlines() if one.startswith("Error")]
            reason = " ".join(lines) or f"netconvert ended with {result.returncode}"
            raise ScenarioError(f"{network}: cannot be written as OpenDRIVE: {reason}")
        content = _DATE.sub(rb"\1", _COMMENT.sub(b"", raw.read_bytes()))
    target.write_bytes(content)
