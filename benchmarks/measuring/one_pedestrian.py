"""A search space of two parameters: one pedestrian who crosses in front of one ego."""

from __future__ import annotations

_PASSAGE = """
warmup_s = 1.0
duration_s = 16.0
egos = { count = 1, depart_lane = "1", routes = [{ edges = "east" }] }

[[pedestrians]]
name = "met"
kind = "line"
lane = "east_1"
from_m = [120.0, -2.5]
to_m = [120.0, 6.0]
speed_mps = "$speed_mps"
start = { ego_arrival_s = "$gap_s" }
"""

SPACE = (
    _PASSAGE
    + """
[parameters.gap_s]
minimum = 1.0
maximum = 6.0

[parameters.speed_mps]
minimum = 1.0
maximum = 2.0
"""
)
"""Evenly."""

DISTRIBUTED = (
    _PASSAGE
    + """
[parameters.gap_s]
minimum = 1.0
maximum = 8.0
distribution = { lognormal = [2.75, 0.3] }

[parameters.speed_mps]
minimum = 0.8
maximum = 2.2
distribution = { normal = [1.46, 0.27] }
"""
)
"""Speeds as the scenario's own table declares them; gaps so short that `aeb` should touch about 1 %: of 600
passages each it touched 16 where their median was 2.5 s, and 3 at 3 s."""
