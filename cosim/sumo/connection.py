"""Starting and ending a simulation: the only place that imports libsumo or traci."""

from __future__ import annotations

import importlib
import io
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from pathlib import Path
from typing import Any

from cosim.errors import InputError, SimulationError

DEBIAN_PACKAGES = {
    "libGL": "libgl1",
    "libX11": "libx11-6",
    "libXext": "libxext6",
    "libXrender": "libxrender1",
}
"""Debian packages of the system libraries that the libsumo wheel needs."""
_REMEDIES = {
    "is not compatible with sublane simulation": (
        "hybrid actuation needs the sublane model; choose --actuation move, or remove laneChangeModel from "
        "the vehicle type"
    )
}
"""What to do about messages of SUMO that name something the user never asked for."""


class Connection:
    """A running simulation; ``sumo`` is the libsumo module or the traci one, with the same calls."""

    def __init__(self, sumo: Any, with_window: bool) -> None:
        self.sumo: Any = sumo
        self.with_window = with_window
        self.pending = False
        """Whether something was moved since the last step; the move would leak into the next simulation."""
        self._open = True

    def close(self) -> None:
        """End the simulation; a second call does nothing."""
        if not self._open:
            return
        self._open = False
        # If the simulation is broken, the user has already been told; here it only has to end.
        with suppress(*self.errors):
            if self.pending:
                self.sumo.simulationStep()
        with suppress(*self.errors):
            self.sumo.close()

    @property
    def errors(self) -> tuple[type[Exception], ...]:
        """The exceptions that calls of ``sumo`` raise."""
        return _errors(self.sumo)

    @contextmanager
    def reporting(self, activity: str) -> Iterator[None]:
        """Turn SUMO's exceptions into `SimulationError`."""
        try:
            yield
        except self.errors as error:
            raise SimulationError(f"SUMO failed while {activity}: {_told(_one_line(error))}") from error


def start(options: Sequence[str], gui: bool = False) -> Connection:
    """Start SUMO with the options of its command line, without the program's name.

    Raises
    ------
    InputError
        If SUMO cannot be loaded, or refuses the options or the input files.
    SimulationError
        If this process runs a simulation already.
    """
    if gui:
        _require_display()
    sumo = _load("traci" if gui else "libsumo")
    if not gui and sumo.isLoaded():
        raise SimulationError("this process runs a simulation already; close it first")
    binary = _sumo_gui() if gui else "sumo"
    # A configuration written for remote control would make SUMO wait for a client to connect.
    extra = ["--start", "true", "--quit-on-end", "true"] if gui else ["--remote-port", "0"]
    refusals: tuple[type[Exception], ...] = (*_errors(sumo), OSError)
    failure: Exception | None = None
    # traci prints each attempt to connect.
    with _heard() as heard, redirect_stdout(io.StringIO()):
        try:
            sumo.start([binary, *options, *extra])
        except refusals as error:
            failure = error
    if failure is not None:
        # libsumo stays half loaded after a refused start.
        if not gui and sumo.isLoaded():
            sumo.close()
        raise InputError(f"SUMO cannot start: {_reason(heard, failure)}") from failure
    return Connection(sumo, gui)


def _errors(sumo: Any) -> tuple[type[Exception], ...]:
    names = ("TraCIException", "FatalTraCIError")
    return tuple(getattr(sumo, name) for name in names if hasattr(sumo, name))


def _load(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        text = str(error)
        for library, package in DEBIAN_PACKAGES.items():
            if library in text:
                needed = " ".join(DEBIAN_PACKAGES.values())
                raise InputError(
                    f"SUMO needs the system library {library} from the Debian package {package}: "
                    f"apt-get install {needed}"
                ) from error
        raise InputError(f"{module} cannot be loaded ({_one_line(error)}); pip install {module}") from error


def _require_display() -> None:
    """Refuse to open a window if there is no screen: traci would try to connect for a minute."""
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        raise InputError(
            "--gui needs a display, and the variable DISPLAY is not set; "
            "without a screen: xvfb-run --auto-servernum cosim run …"
        )


def _sumo_gui() -> str:
    home = Path(importlib.import_module("sumo").SUMO_HOME)
    found = shutil.which("sumo-gui") or shutil.which("sumo-gui", path=str(home / "bin"))
    if found is None:
        raise InputError("sumo-gui was not found; it comes with the package eclipse-sumo")
    return found


class _Heard:
    text = ""


@contextmanager
def _heard() -> Iterator[_Heard]:
    """Collect what SUMO writes to the standard error stream: its exceptions do not say what was wrong."""
    heard = _Heard()
    sys.stderr.flush()
    saved = os.dup(2)
    with tempfile.TemporaryFile() as sink:
        os.dup2(sink.fileno(), 2)
        try:
            yield heard
        finally:
            os.dup2(saved, 2)
            os.close(saved)
            sink.seek(0)
            heard.text = sink.read().decode(errors="replace")


def _reason(heard: _Heard, error: Exception) -> str:
    for line in heard.text.splitlines():
        if "unable to open display" in line:
            return f"sumo-gui was {line.rpartition(': ')[2].strip()}"
    lines = [line.strip() for line in heard.text.splitlines() if line.startswith("Error:")]
    said = " ".join(line.removeprefix("Error:").strip() for line in lines[:2])
    return _told(said or _one_line(error))


def _told(message: str) -> str:
    """Return a message of SUMO, followed by what to do about it if that is known."""
    return "; ".join([message, *(remedy for words, remedy in _REMEDIES.items() if words in message)])


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
