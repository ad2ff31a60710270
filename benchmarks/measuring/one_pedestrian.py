"""A search space of two parameters: one pedestrian who crosses in front of one ego."""

from __future__ import annotations

SPACE = """
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

[parameters.gap_s]
minimum = 1.0
maximum = 6.0

[parameters.speed_mps]
minimum = 1.0
maximum = 2.0
"""
