"""crossings.geojson: the crossings as points in WGS 84 (RFC 7946), for QGIS and other tools."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from analysis.screening.crossings_table import CROSSINGS
from analysis.tables.cells import Row

FILE = "crossings.geojson"
_PLACE = ("longitude_deg", "latitude_deg")


def features(rows: Sequence[Row]) -> dict[str, Any] | None:
    """Return a collection with a feature for each crossing; ``None`` for a network without a projection."""
    if any(row.get(name) is None for row in rows for name in _PLACE):
        return None
    names = [name for name in CROSSINGS.names() if name not in _PLACE]
    return {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "geometry": {"type": "Point", "coordinates": [row[name] for name in _PLACE]},
                "properties": {name: row.get(name) for name in names},
            }
            for row in rows
        ],
    }
