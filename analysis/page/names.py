"""Names of the files and folders that a report writes."""

from __future__ import annotations

PAGE = "report.html"
DATA = "report_data"
REPLAYS = "replays"
