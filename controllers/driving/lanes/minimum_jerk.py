"""The profile of least jerk, along which an offset changes smoothly."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray


def minimum_jerk(fraction: FloatArray) -> FloatArray:
    """Return the profile ``10 s^3 - 15 s^4 + 6 s^5`` for s from 0 to 1; outside it is constant.

    >>> minimum_jerk(np.array([-1.0, 0.0, 0.5, 1.0, 2.0])).tolist()
    [0.0, 0.0, 0.5, 1.0, 1.0]
    """
    s = np.clip(fraction, 0.0, 1.0)
    return s**3 * (10.0 + s * (-15.0 + 6.0 * s))
