"""Controllers named by their address: ``./patient.py``, ``process:./my_controller``, ``fmu:acc.fmu``."""

from __future__ import annotations

import hashlib
import importlib.util
import shlex
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from controllers.interface import Controller


class AddressError(ValueError):
    """There is nothing at an address, or nothing that can drive; the message is one line for the user."""


PROCESS, FMU = "process:", "fmu:"
"""How the addresses of programs and of functional mock-up units begin."""


@dataclass(frozen=True, slots=True)
class Found:
    """The controller at an address, with the names that a module of the catalogue has."""

    build: Callable[..., Controller]
    documentation: str


def is_address(name: str) -> bool:
    """Return whether a name is an address and not a name of the catalogue.

    >>> is_address("./patient.py"), is_address("process:node drive.js"), is_address("vo_mpc")
    (True, True, False)
    """
    return name.startswith((PROCESS, FMU)) or name.endswith(".py")


def files(name: str) -> dict[str, str]:
    """Return the names of the files that make up a controller at an address, and their SHA-256."""
    paths = [Path(word) for word in _words(name)] if is_address(name) else []
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in paths if path.is_file()}


def find(name: str) -> Found:
    """Return the controller at an address.

    Raises
    ------
    AddressError
        If there is no such file, or it has no function ``build``.
    Exception
        Whatever the file raises when it is loaded.
    """
    if name.startswith(PROCESS):
        from controllers.outside.process.driver import builder

        command = name.removeprefix(PROCESS)
        return Found(builder(command), f"The program {command}.")
    if name.startswith(FMU):
        from controllers.outside.fmu.driver import builder as unit_builder

        path = name.removeprefix(FMU)
        return Found(unit_builder(path), f"The functional mock-up unit {path}.")
    module = _python_file(Path(name))
    if not callable(getattr(module, "build", None)):
        raise AddressError(f"controller '{name}' has no function build(**parameters)")
    return Found(module.build, module.__doc__ or f"The controller in {name}.")


def _words(name: str) -> list[str]:
    """Return the parts of an address that may be files."""
    if name.startswith(PROCESS):
        return shlex.split(name.removeprefix(PROCESS))
    if name.startswith(FMU):
        unit = Path(name.removeprefix(FMU))
        return [str(unit), str(unit.with_suffix(".toml"))]
    return [name]


def _python_file(path: Path) -> ModuleType:
    if not path.is_file():
        raise AddressError(f"no controller '{path}': there is no such file")
    # No package has this name. It depends on the file's content, so that a changed file is loaded anew.
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    name = f"_controller_{path.stem}_{digest}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise AddressError(f"controller '{path}' cannot be loaded as Python")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses and pickling look a module up
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module
