"""Runs one unit for a controller in another process, so that foreign machine code never shares one with SUMO.

:mod:`controllers.outside.fmu.driver` starts it as ``python -m controllers.outside.fmu.server acc.fmu``.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from controllers.outside.fmu.unit import Unit, UnitError
from controllers.outside.process.wire import Wire


def serve(path: Path) -> None:
    """Answer requests until the controller sends the end."""
    wire = Wire.to_parent()
    wire.send({"type": "hello", "token": os.environ["COSIM_TOKEN"]})
    try:
        unit = Unit(path)
        kinds = ("input", "output", "parameter")
        wire.send({"type": "variables", **{kind: unit.variables(kind) for kind in kinds}})
        while (message := wire.receive())["type"] != "end":
            wire.send(_answer(unit, message))
        unit.close()
    except UnitError as error:
        wire.send({"type": "error", "text": str(error)})


def _answer(unit: Unit, message: dict[str, Any]) -> dict[str, Any]:
    if message["type"] == "start":
        unit.start(message["parameters"])
        return {"type": "started"}
    unit.step(message["inputs"], message["duration_s"])
    return {"type": "outputs", "values": [unit.read(name) for name in message["outputs"]]}


if __name__ == "__main__":
    serve(Path(sys.argv[1]))
    sys.stdout.flush()
    os._exit(0)  # ends without unloading the unit's library, whose clean-up does not matter any more
