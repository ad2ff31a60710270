"""The crossing study as Markdown: one block per scenario and demand, one column per controller."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import pandas as pd

from analysis.markdown import table as markdown_table

ORDER = ("vo_mpc", "sumo", "aeb")

_LINES = (
    ("egos", "{egos:.0f}"),
    ("passages with a pedestrian (entered encounters)", "{passages:.0f} ({encounters:.0f})"),
    ("**contacts** (95 % upper bound of the rate)", "**{contacts:.0f}** ({contact_upper_95:.1%})"),
    ("passages with TTC < 1.5 s (95 % upper bound)", "{ttc_lt_1p5_share:.1%} ({ttc_lt_1p5_upper_95:.1%})"),
    (
        "clearance min / 1 % / 5 % [m]",
        "{clearance_min_m:.2f} / {clearance_p01_m:.2f} / {clearance_p05_m:.2f}",
    ),
    (
        "deceleration p50 / p95 / max [m/s²]",
        "{decel_p50_mps2:.2f} / {decel_p95_mps2:.2f} / {decel_max_mps2:.2f}",
    ),
    ("… above 4.5 without a late entry", "{decel_gt_4p5_not_late:.0f}"),
    ("largest jerk of a passage p50 / p95 [m/s³]", "{jerk_p50_mps3:.1f} / {jerk_p95_mps3:.1f}"),
    ("mean delay of a trip [s]", "{delay_mean_s:.1f}"),
    (
        "delay against SUMO's driver, paired by seed and demand [s] (95 %)",
        "{delay_minus_sumo_s:+.1f} ({delay_minus_sumo_low_s:+.1f} … {delay_minus_sumo_high_s:+.1f})",
    ),
    ("steps with slack > 0.05 m", "{slack_share:.2%}"),
    ("changes of passing side per passage", "{side_changes_per_passage:.2f}"),
    ("stops on a crossing / deadlocks", "{stopped_on_crossing:.0f} / {deadlocks:.0f}"),
    (
        "overlaps with vehicles, closed by the ego (all)",
        "{vehicle_overlaps_ego_closed:.0f} ({vehicle_overlaps:.0f})",
    ),
    ("completed lane changes", "{lane_changes:.0f}"),
    (
        "decisions straight / lane change / autonomous",
        "{straight:.0f} / {lane_change:.0f} / {autonomous:.0f}",
    ),
    ("unsolved steps, interventions", "{unsolved:.0f}, {interventions:.0f}"),
    ("control step p95 [ms]", "{compute_p95_ms:.1f}"),
)


def markdown(table: pd.DataFrame, pooled: pd.DataFrame) -> str:
    """Return the tables as Markdown: first all demands together, then each demand."""
    blocks = [_block(f"{scenario}, all demands", group) for scenario, group in pooled.groupby("scenario_id")]
    for (scenario, vehicles, people), group in table.groupby(
        ["scenario_id", "vehicles_per_hour", "pedestrians_per_hour"]
    ):
        title = f"{scenario}, {vehicles:.0f} veh/h and direction, {people:.0f} ped/h and crossing"
        blocks.append(_block(title, group))
    return "\n\n".join(blocks) + "\n"


def _block(title: str, group: pd.DataFrame) -> str:
    rows = {row["controller"]: row for row in group.to_dict("records")}
    names = [name for name in ORDER if name in rows] + sorted(set(rows) - set(ORDER))
    lines = [[label, *(_cell(text, rows[name]) for name in names)] for label, text in _LINES]
    return f"### {title}\n\n{markdown_table(['', *names], lines)}"


def _cell(text: str, row: dict[Hashable, Any]) -> str:
    return text.format(**{str(key): value for key, value in row.items()})
