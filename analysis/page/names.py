"""Names of what a report writes into its folder."""

from __future__ import annotations

PAGE = "report.html"
DATA = "report_data"
REPLAYS = "replays"
