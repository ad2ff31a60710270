"""The names that programs may rely on, and what importing them costs."""

from __future__ import annotations

import pkgutil
import subprocess
import sys
from importlib.resources import files

import pytest

import cosim

NAMES = {
    *("run", "load", "batch", "compare", "analyse"),
    *("Run", "Study", "Comparison"),
    *("CosimError", "InputError", "SimulationError"),
}


def test_the_public_names_are_these_and_few() -> None:
    assert set(cosim.__all__) == NAMES
    assert len(NAMES) <= 12
    for name in NAMES:
        assert getattr(cosim, name).__doc__, name
        assert name in dir(cosim)


def test_no_submodule_hides_a_public_name() -> None:
    submodules = {found.name for found in pkgutil.iter_modules(cosim.__path__)}
    assert not submodules & NAMES


def test_an_unknown_name_is_answered_by_the_known_ones() -> None:
    with pytest.raises(AttributeError, match=r"no attribute 'simulate'; there are .*run"):
        cosim.simulate  # noqa: B018  the point of the test


def test_importing_loads_neither_sumo_nor_pandas() -> None:
    code = (
        "import sys, cosim; from cosim import InputError; "
        "print([m for m in ('libsumo', 'traci', 'pandas', 'numpy', 'pyarrow', 'matplotlib') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_packages_are_typed() -> None:
    for name in ("cosim", "controllers", "analysis"):
        assert files(name).joinpath("py.typed").is_file(), name
