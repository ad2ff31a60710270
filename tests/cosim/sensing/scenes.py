"""Scenes for sensing models: an ego at the origin that points east."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from controllers.interface import Body
from cosim.arrays import FloatArray
from cosim.sensing import catalog
from cosim.sensing.interface import Scene, Sensing, Site

SITE = Site(
    {"zebra": np.array([[30.0, -4.0], [30.0, 4.0]])},
    np.array([[-200.0, 0.0, 400.0, 0.0]]),
    np.zeros((0, 4)),
)
Walker = tuple[str, float, float, float, float]
"""Name, x, y, x speed, y speed [m, m/s]."""
Car = tuple[float, float, float]
"""Front bumper [m] and heading [rad]; 12 m long and 2.5 m wide."""


def scene(
    walkers: Sequence[Walker], time: float = 0.0, cars: Sequence[Car] = (), x: float = 0.0, ego: str = "ego"
) -> Scene:
    """Return a scene with everybody at their place at that time."""
    table = np.array([one[1:] for one in walkers], dtype=np.float64).reshape(-1, 4)
    traffic = np.array(cars, dtype=np.float64).reshape(-1, 3)
    return Scene(
        ego,
        time,
        round(10.0 * time),
        x,
        0.0,
        0.0,
        Body(),
        tuple(one[0] for one in walkers),
        table[:, :2] + time * table[:, 2:],
        table[:, 2:],
        np.full(len(table), 0.25),
        traffic[:, :2],
        traffic[:, 2],
        np.full(len(traffic), 12.0),
        np.full(len(traffic), 2.5),
    )


def exactly(name: str, **values: object) -> Sensing:
    """Return a model without noise, misses, latency and losses, that confirms at once and sees all around."""
    ideal: dict[str, object] = {
        "field_of_view_deg": 360.0,
        "position_noise_m": 0.0,
        "velocity_noise_mps": 0.0,
        "miss_probability": 0.0,
        "confirm_hits": 1,
        "confirm_looks": 1,
        "unit_position_noise_m": 0.0,
        "unit_velocity_noise_mps": 0.0,
        "unit_miss_probability": 0.0,
        "latency_ms": 0.0,
        "loss_probability": 0.0,
    }
    known = catalog.parameters(name)
    return catalog.build(name, {**{key: ideal[key] for key in ideal if key in known}, **values})


def off(believed: FloatArray, true: FloatArray) -> float:
    """Return the largest difference [m]."""
    return float(np.abs(believed - true).max())
