"""The same arithmetic as NumPy runs it, or compiled by Numba.

A module of :mod:`controllers.numerics` holds plain functions in the part of Python and NumPy that Numba
understands. :func:`code_of` gives the module itself, or a copy of it whose functions are compiled. What
Numba writes down of a function is good for as long as its file does not change, so such a module calls only
functions of its own and reads only its own constants. Where compiled loops are much quicker than NumPy, or
where Numba lacks something, a function ``name_in_loops`` takes the place of ``name`` when compiled.

Both give the same values up to rounding, not the same bits: that something is compiled is a parameter.
"""

from __future__ import annotations

import importlib.util
from functools import cache
from types import FunctionType, ModuleType
from typing import Any

IN_LOOPS = "_in_loops"
"""Ends the name of a function that takes another's place when compiled."""


@cache
def code_of(module: ModuleType, compiled: bool) -> ModuleType:
    """Return a module of arithmetic as it stands, or compiled.

    Functions are compiled when first called, for the types they are called with; the machine code is kept
    beside the module, or in the user's cache where that cannot be written.

    Raises
    ------
    ValueError
        If it shall be compiled and Numba is not installed.
    """
    if not compiled:
        return module
    check_compiler()
    code = ModuleType(module.__name__)
    code.__dict__.update(module.__dict__)
    own = {
        name: function
        for name, function in vars(module).items()
        if isinstance(function, FunctionType) and function.__module__ == module.__name__
    }
    for name, function in own.items():
        if not name.endswith(IN_LOOPS):
            text = own.get(name + IN_LOOPS, function)
            # Its globals are the copy's: compiled functions call compiled ones.
            copied = FunctionType(text.__code__, code.__dict__, text.__name__, text.__defaults__)
            code.__dict__[name] = _compiled(copied)
    return code


def _compiled(function: FunctionType) -> Any:
    import numba  # costs a third of a second, which only those pay who ask for it

    try:
        return numba.njit(function, cache=True, error_model="numpy")
    except RuntimeError:  # there is no place for its machine code
        return numba.njit(function, error_model="numpy")


def check_compiler() -> None:
    """Raise ``ValueError``, with what to install, when Numba is missing."""
    if importlib.util.find_spec("numba") is None:
        raise ValueError("compiled needs Numba, which is not installed: pip install 'sumo-cosim[fast]'")
