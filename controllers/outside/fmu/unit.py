"""A co-simulation unit of FMI 2.0 or 3.0, run by FMPy."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Mapping
from pathlib import Path
from typing import Any

COSIMULATION = "CoSimulation"
_REAL = ("Real", "Float64")


class UnitError(ValueError):
    """A unit cannot be used, or has failed; the message is one line for the user."""


class Unit:
    """One instance of a unit, at time 0.

    Parameters
    ----------
    path
        The ``.fmu`` file.

    Raises
    ------
    UnitError
        If FMPy is missing, or the file is no co-simulation unit for this platform.
    """

    def __init__(self, path: Path) -> None:
        try:
            import fmpy
        except ImportError as error:
            raise UnitError("fmu: needs FMPy: pip install fmpy") from error
        self._path = path
        if not path.is_file():
            raise UnitError(f"{path}: there is no such file")
        try:
            self._model: Any = fmpy.read_model_description(str(path))
        except Exception as error:  # FMPy raises what zip and XML readers raise
            raise UnitError(f"{path}: is no functional mock-up unit ({_line(error)})") from error
        version = str(self._model.fmiVersion)
        if self._model.coSimulation is None or not version.startswith(("2", "3")):
            raise UnitError(f"{path}: expected a co-simulation unit of FMI 2.0 or 3.0, this is FMI {version}")
        there = fmpy.supported_platforms(str(path))
        wanted = fmpy.platform_tuple if version.startswith("3") else fmpy.platform
        if wanted not in there and fmpy.platform not in there:
            raise UnitError(
                f"{path}: is for {', '.join(there) or 'no platform'}; this machine needs {wanted}"
            )
        self._is_3 = version.startswith("3")
        self._references = {
            one.name: one.valueReference for one in self._model.modelVariables if one.type in _REAL
        }
        self._time = 0.0

    def variables(self, *causalities: str) -> list[str]:
        """Return the real-valued variables with one of these causalities."""
        return [
            one.name
            for one in self._model.modelVariables
            if one.type in _REAL and one.causality in causalities
        ]

    def start(self, parameters: Mapping[str, float]) -> None:
        """Begin at time 0.

        Raises
        ------
        UnitError
            If the unit cannot be loaded or refuses.
        """
        import fmpy

        folder = tempfile.mkdtemp(prefix="cosim-fmu-")
        self._remove = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        try:
            fmpy.extract(str(self._path), folder)
            self._slave: Any = fmpy.simulation.instantiate_fmu(folder, self._model, COSIMULATION)
            if self._is_3:
                self.write(parameters)
                self._slave.enterInitializationMode(startTime=0.0)
            else:
                self._slave.setupExperiment(startTime=0.0)
                self.write(parameters)
                self._slave.enterInitializationMode()
            self._slave.exitInitializationMode()
        except Exception as error:  # a foreign library, through FMPy
            raise UnitError(f"{self._path}: cannot be started ({_line(error)})") from error

    def write(self, values: Mapping[str, float]) -> None:
        """Set variables by their names."""
        if values:
            references = [self._references[name] for name in values]
            setter = self._slave.setFloat64 if self._is_3 else self._slave.setReal
            setter(references, list(values.values()))

    def read(self, name: str) -> float:
        """Return the value of a variable."""
        getter = self._slave.getFloat64 if self._is_3 else self._slave.getReal
        return float(getter([self._references[name]])[0])

    def step(self, inputs: Mapping[str, float], duration: float) -> None:
        """Set the inputs and advance the unit by ``duration`` [s].

        Raises
        ------
        UnitError
            If the unit fails.
        """
        try:
            self.write(inputs)
            self._slave.doStep(currentCommunicationPoint=self._time, communicationStepSize=duration)
        except Exception as error:  # a foreign library, through FMPy
            raise UnitError(f"{self._path}: failed at {self._time:.2f} s ({_line(error)})") from error
        self._time += duration

    def close(self) -> None:
        """Terminate the unit; a second call does nothing."""
        if self._remove.alive:
            self._slave.terminate()
            self._slave.freeInstance()
        self._remove()


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
