"""The tables that docs/pedestrians.md shows can be given, and it names every key there is."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from pydantic import BaseModel

from sumo_scenarios.pedestrian_tables import (
    TABLES,
    GroupTable,
    MannerTable,
    StartTable,
    WalkerTable,
    read_pedestrians,
)

PAGE = (Path(__file__).parents[1] / "docs/pedestrians.md").read_text(encoding="utf-8")


def test_the_rows_of_the_page_are_rows() -> None:
    (text,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    rows = tomllib.loads(text)["pedestrians"]
    assert [table.kind for table in read_pedestrians(rows, {}, Path("scenario.toml"))] == [
        "line",
        "jaywalk",
        "crossing",
    ]


def test_the_page_names_every_key() -> None:
    tables: tuple[type[BaseModel], ...] = (*TABLES.values(), WalkerTable, StartTable, MannerTable, GroupTable)
    for table in tables:
        for key in table.model_fields:
            assert f"`{key}`" in PAGE or f"{key} =" in PAGE, f"docs/pedestrians.md does not name {key}"
