"""Pedestrian delay at an unsignalised crossing by the formula of the Highway Capacity Manual.

For comparison with the delay that a run measured; it needs the vehicle flow, which a recording of the
egos' surroundings does not hold. Arrivals are random and the crossing is made in one stage.
"""

from __future__ import annotations

import math

LEVELS = ((5.0, "A"), (10.0, "B"), (20.0, "C"), (30.0, "D"), (45.0, "E"), (math.inf, "F"))
"""Mean delay below which a level of service holds [s], HCM 2000 and 2010."""


def level_of_service(delay: float) -> str:
    """Return the level of service of a mean delay [s].

    >>> level_of_service(13.9)
    'C'
    """
    return next(level for limit, level in LEVELS if delay < limit)


def crossing_delay(
    length: float, flow: float, yield_rate: float, walking_speed: float = 1.067, start_up: float = 3.0
) -> float:
    """Return the mean delay of a pedestrian at a one-lane crossing [s].

    The critical headway is ``t_c = length / walking_speed + start_up``; ``P_d = 1 - exp(-t_c flow)`` have to
    wait, ``d_gd`` on average for a gap, and each vehicle that comes in the meantime, one per mean short
    headway ``h``, yields with ``yield_rate``.

    Parameters
    ----------
    length
        Of the crossing [m].
    flow
        Vehicles per second, both directions of the lane together [1/s].
    yield_rate
        Share of drivers who yield, 0 to 1.
    walking_speed
        [m/s]
    start_up
        Start-up and end clearance time [s].

    Raises
    ------
    ValueError
        If a length, flow or speed is not positive or the rate is outside 0 to 1.

    Notes
    -----
    [HCM2010]_; the number of vehicles that a pedestrian can be yielded to by is ``int(exp(flow t_c))``, as in
    NCHRP 17-87.
    """
    if not (length > 0.0 and flow > 0.0 and walking_speed > 0.0):
        raise ValueError(f"length, flow and speed must be above 0, not {length}, {flow}, {walking_speed}")
    if not 0.0 <= yield_rate <= 1.0:
        raise ValueError(f"yield_rate must lie between 0 and 1, not {yield_rate}")
    critical = length / walking_speed + start_up
    growth = math.exp(flow * critical)
    delayed = 1.0 - 1.0 / growth
    for_a_gap = (growth - flow * critical - 1.0) / flow / delayed
    headway = (1.0 / flow - (critical + 1.0 / flow) / growth) / (1.0 - 1.0 / growth)
    yielded, delay = 0.0, 0.0
    for vehicle in range(1, int(growth) + 1):
        share = delayed * yield_rate * (1.0 - yield_rate) ** (vehicle - 1)
        yielded += share
        delay += headway * (vehicle - 0.5) * share
    return delay + (delayed - yielded) * for_a_gap
