"""Writes a trial as a ``scenario.toml``, which ``cosim run`` takes like any other."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from analysis.search.axes import Point
from cosim.batches.study import toml_value
from cosim.errors import InputError
from cosim.search.space import LONGEST_PASSAGE_S, PASSAGE, Space, filled
from cosim.search.subject import Subject
from sumo_scenarios import library

_RUN_KEYS = ("duration_s", "warmup_s", "step_s")
_LONGEST_STEP_S = 0.1


def scenario_text(subject: Subject, point: Point, folder: Path, description: str) -> str:
    """Return the content of the scenario.toml of a point.

    Parameters
    ----------
    subject
    point
        A value for each axis.
    folder
        Folder of the file; paths in the file are relative to it.
    description
        One line.

    Raises
    ------
    InputError
        If the passage is too long, or a table names something that does not exist.
    """
    content = _content(subject, point, folder, description)
    lines = []
    for key, value in content.items():
        if key == "pedestrians" or key == "criteria":
            for row in value:
                lines += ["", f"[[{key}]]", *(f"{name} = {toml_value(one)}" for name, one in row.items())]
        elif isinstance(value, Mapping):
            lines += ["", f"[{key}]", *(f"{name} = {toml_value(one)}" for name, one in value.items())]
        else:
            lines.append(f"{key} = {toml_value(value)}")
    return "\n".join(lines) + "\n"


def _content(subject: Subject, point: Point, folder: Path, description: str) -> dict[str, Any]:
    table, place = subject.space.table, subject.space.place
    values: dict[str, Any] = dict(point)
    if subject.passages:
        name = str(point.get(PASSAGE) or next(iter(subject.passages)))
        passage = subject.passages[name]
        values |= {PASSAGE: name, "crossing": passage.crossing, "route": " ".join(passage.edges)}
    content: dict[str, Any] = {"description": description}
    if subject.configured:
        content["sumocfg"] = _relative(subject.place, folder)
    else:
        built_in = library.is_built_in(subject.scenario)
        content["base"] = subject.scenario if built_in else _relative(_folder_of(subject.place), folder)
    content |= {"duration_s": table.duration_s, "warmup_s": float(filled(table.warmup_s, values, place))}
    if isinstance(table.warmup_s, str):
        # The passage has the same length whenever it begins.
        content["duration_s"] = round(table.duration_s + content["warmup_s"], 6)
    if subject.loaded.step_s > _LONGEST_STEP_S:
        content["step_s"] = _LONGEST_STEP_S
    content |= {key: float(subject.values[key]) for key in _RUN_KEYS if key in subject.values}
    if content["duration_s"] - content["warmup_s"] > LONGEST_PASSAGE_S + 1e-6:
        raise InputError(
            f"{place}: a trial takes {content['duration_s'] - content['warmup_s']:g} s after its warm-up; "
            f"expected at most {LONGEST_PASSAGE_S:g} s, a single passage"
        )
    own = {key: text for key, text in subject.values.items() if key not in _RUN_KEYS}
    of_scenario = set(library.parameter_names(subject.loaded)) - subject.space.named
    searched = {key: value for key, value in point.items() if key in of_scenario}
    parts = {
        "values": {**own, **filled(table.values, values, place), **searched},
        "egos": filled(table.egos, values, place),
        "sensing": filled(table.sensing, values, place),
        "pedestrians": [
            _with_file(_with_manner(row), subject.space, folder)
            for row in filled(table.pedestrians, values, place)
        ],
        "criteria": list(subject.criteria_tables),
    }
    return content | {key: part for key, part in parts.items() if part}


def _with_manner(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row with only the manner whose kind its key ``manner`` names."""
    if "manner" not in row:
        return dict(row)
    rest = {key: value for key, value in row.items() if key != "manner"}
    manners = [one for one in row.get("manners", []) if one.get("kind") == row["manner"]]
    if not manners:
        kinds = ", ".join(str(one.get("kind")) for one in row.get("manners", [])) or "none"
        raise InputError(f"pedestrians: manner {row['manner']!r}: expected one of its manners: {kinds}")
    return {**rest, "manners": manners}


def _with_file(row: dict[str, Any], space: Space, folder: Path) -> dict[str, Any]:
    """Return a row with its trajectory file relative to ``folder``, not to the folder of the space."""
    if space.folder is None or not isinstance(row.get("file"), str):
        return row
    return {**row, "file": _relative(str(space.folder / row["file"]), folder)}


def _folder_of(place: str) -> str:
    path = Path(place)
    return str(path.parent if path.name == library.DEFINITION else path)


def _relative(place: str, folder: Path) -> str:
    return Path(os.path.relpath(place, folder.resolve())).as_posix()
