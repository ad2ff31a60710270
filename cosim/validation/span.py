"""Selects a part of a recording."""

from __future__ import annotations

import math

import pandas as pd

from cosim.errors import InputError


def span_of(begin_s: float | None, end_s: float | None) -> tuple[float, float] | None:
    """Return the part between two times of a recording [s]; ``None`` for all of it.

    Raises
    ------
    InputError
        If the part ends before it begins.

    Examples
    --------
    >>> span_of(None, 450.0)
    (0.0, 450.0)
    """
    if begin_s is None and end_s is None:
        return None
    span = (begin_s or 0.0, math.inf if end_s is None else end_s)
    if not 0.0 <= span[0] < span[1]:
        raise InputError(f"--from {span[0]:g} --to {span[1]:g}: expected a part of the recording")
    return span


def spanned(frame: pd.DataFrame, span: tuple[float, float] | None, step_s: float) -> pd.DataFrame:
    """Return the samples of road users who appear in a part of the recording, with times from its beginning.

    Parameters
    ----------
    frame : samples as `cosim.tracks.fit.placed` returns them
    span : the part; ``None`` for all of the recording [s]
    step_s : time step of the recording [s]
    """
    if span is None:
        return frame
    first = frame.groupby("id")["time_s"].transform("min")
    part = frame[(first >= span[0]) & (first < span[1])].copy()
    steps = round(span[0] / step_s)
    part["time_s"] = (part["time_s"] - steps * step_s).round(6)
    part["step"] -= steps
    return part
