"""A very long run on a measured junction."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from measuring.resident import table


def paragraphs(found: Mapping[str, Any]) -> list[str]:
    """Return the section's Markdown."""
    return [
        "## Memory over twelve simulated hours in Braunschweig",
        f"`fokr_bs_demo`, as SUMO ships it, with `{found['controller']}` for {found['ego_share']:.0%} of the "
        f"cars and steps of {found['step_s']:g} s; every hour the measured vehicles depart again, one of ten "
        "cyclists and one of four pedestrians comes (more jam the junction). "
        f"{found['simulated_s'] / 3600.0:g} simulated hours took {found['took_s'] / 60.0:.0f} min: "
        f"{found['ego_count']} egos, {found['n_entered']} entered encounters, "
        f"{found['n_collisions']} contacts ({found['n_collisions_preventable']} preventable), "
        f"{found['recorded_mb']:.0f} MB recorded. After the first "
        f"{found['settled_s'] / 3600.0:g} h memory grows by {found['mb_per_hour']:+.1f} MB per simulated "
        "hour. The recording is judged by a process of its own, which took {found['judging_cpu_s']:.0f} s of "
        f"processor time and held at most {found['analysed_mb']:.0f} MB. {found['egos_given_up']} egos were "
        f"given up, {found['deadlock']} stood for too long with a free road.",
        table(found, 12, "simulated h", lambda now: f"{now / 3600.0:.1f}"),
    ]
