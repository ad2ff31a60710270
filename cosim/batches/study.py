"""The keys of a study file; every other key is an error."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from analysis.recording.extent import EGOS
from controllers.outside.addresses import is_address
from cosim.errors import InputError
from cosim.toml_files import read_toml
from sumo_scenarios.errors import did_you_mean, most_telling

Value = bool | int | float | str
LARGEST_SEED = 2**31 - 1
MOST_SEEDS = 1_000_000
"""Largest number of seeds in a range; more are probably a typing error and would fill the memory."""
DEFAULT_TIMEOUT_S = 3600.0

_RANGE = re.compile(r"\s*(\d+)\s*(?:-\s*(\d+)\s*)?")


class StudyTable(BaseModel):
    """The whole of a study file."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, use_attribute_docstrings=True)

    scenarios: list[str]
    """Names, or paths relative to the study file."""
    controllers: list[str]
    """Names of controllers, as ``cosim list controllers`` shows them; or addresses of others."""
    sensing: list[str] = []
    """Sensing models; none given: as each scenario says."""
    seeds: str | list[int]
    """Seeds of the runs: a text such as ``"1-30"`` or ``"1, 5-9"``, or a list."""
    record: str = EGOS
    """Whom the runs record, as ``cosim run --record`` does."""
    settings: dict[str, Value] = Field(default={}, alias="set")
    """Parameters of the scenario, the sensing model or the controller, of every run that has them."""
    vary: dict[str, list[Value]] = {}
    """The same with several values each; every combination is run."""
    run_timeout_s: Annotated[float, Field(gt=0, allow_inf_nan=False)] = DEFAULT_TIMEOUT_S
    """Wall-clock time after which a run has failed [s]."""
    criteria: list[dict[str, Any]] = []
    """What ``cosim check`` holds the results against."""


def read_study(path: Path, allow_programs: bool = False) -> StudyTable:
    """Return the checked content of a study file.

    Parameters
    ----------
    path
    allow_programs
        Whether the file may name controllers by an address, whose code is executed. A file from strangers
        must not execute anything.

    Raises
    ------
    InputError
        One line with file, key and what was expected.
    """
    raw = read_toml(path)
    study = study_of(raw, str(path))
    addresses = [name for name in study.controllers if is_address(name)]
    if addresses and not allow_programs:
        raise InputError(
            f"{path}: controllers: {addresses[0]!r} would execute a file: allow it with cosim batch "
            "--allow-programs, or name it on the command line with --controller"
        )
    return study


def study_of(content: Mapping[str, Any], name: str) -> StudyTable:
    """Return the checked study with this content.

    Parameters
    ----------
    content : Mapping
        Content of a study file.
    name : str
        Name of the study, for messages.

    Raises
    ------
    InputError
        One line with name, key and what was expected.
    """
    try:
        study = StudyTable.model_validate(content)
        _check(study)
        parse_seeds(study.seeds)
    except ValidationError as error:
        raise InputError(f"{name}: {_first_line(error)}") from error
    except ValueError as error:
        raise InputError(f"{name}: {error}") from error
    return study


def study_text(study: StudyTable) -> str:
    """Return the text of a study file with this content.

    Examples
    --------
    >>> content = {"scenarios": ["a"], "controllers": ["b"], "seeds": "1-2", "set": {"duration_s": 60.0}}
    >>> print(study_text(study_of(content, "study")), end="")
    scenarios = ["a"]
    controllers = ["b"]
    seeds = "1-2"
    set = { duration_s = 60.0 }
    """
    content = study.model_dump(by_alias=True, exclude_unset=True)
    return "".join(f"{key} = {toml_value(value)}\n" for key, value in content.items())


def toml_value(value: Any) -> str:
    """Return a value as TOML writes it, with a table on one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(name)} = {toml_value(each)}" for name, each in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    # TOML writes texts, whole numbers and truth values as JSON does, except for this one character.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else toml_value(name)


def parse_seeds(seeds: str | list[int]) -> tuple[int, ...]:
    """Return the seeds of ``"1-30"``, ``"1-10, 21"`` or a list.

    Raises
    ------
    ValueError
        If it is neither, or names a seed twice.

    Examples
    --------
    >>> parse_seeds("1-3, 7")
    (1, 2, 3, 7)
    """
    found = tuple(seeds) if isinstance(seeds, list) else tuple(_from_ranges(seeds))
    if not found:
        raise ValueError("seeds: expected at least one seed, got none")
    for seed in (min(found), max(found)):
        if not 0 <= seed <= LARGEST_SEED:
            raise ValueError(f"seeds: expected whole numbers from 0 to {LARGEST_SEED}, got {seed}")
    if (twice := _first_repeated(found)) is not None:
        raise ValueError(f"seeds: {twice} is named twice")
    return found


def check_seeds(seeds: str, name: str) -> None:
    """Refuse invalid seeds before anything expensive happens.

    Raises
    ------
    InputError
        If the seeds are invalid; the message begins with ``name``, the option that got them.
    """
    try:
        parse_seeds(seeds)
    except ValueError as error:
        raise InputError(f"{name}: {error}") from error


def _from_ranges(text: str) -> list[int]:
    found: list[int] = []
    for part in text.split(","):
        match = _RANGE.fullmatch(part)
        if match is None:
            raise ValueError(
                f'seeds = "{text}": a range such as "1-30", or a list such as [1, 2, 5], expected'
            )
        first = int(match[1])
        last = int(match[2] or first)
        if last < first:
            raise ValueError(f'seeds = "{text}": expected the smaller seed of a range first')
        if last - first >= MOST_SEEDS:
            raise ValueError(f'seeds = "{text}": at most {MOST_SEEDS} seeds expected')
        found += range(first, last + 1)
    return found


def _check(study: StudyTable) -> None:
    """Refuse a matrix that is empty or that has the same run twice."""
    axes: list[tuple[str, Iterable[Value]]] = [
        ("scenarios", study.scenarios),
        ("controllers", study.controllers),
        *([("sensing", study.sensing)] if "sensing" in study.model_fields_set else []),
        *((f"vary.{key}", values) for key, values in study.vary.items()),
    ]
    for name, values in axes:
        if not values:
            raise ValueError(f"{name}: expected at least one, got an empty list; the study would have no run")
        if (twice := _first_repeated(values)) is not None:
            raise ValueError(f"{name}: {twice!r} is named twice")
    for key in study.vary:
        if key in study.settings:
            raise ValueError(f"{key} is in [set] and in [vary]; expected in one of them")
    if study.criteria:
        _check_criteria(study.criteria)


def _check_criteria(tables: Sequence[Mapping[str, Any]]) -> None:
    """Refuse criteria that a check could not judge, as a batch passes them on to one."""
    from analysis.criteria.reading import CriterionError, read_criteria  # loads every metric

    try:
        read_criteria(tables)
    except CriterionError as error:
        raise ValueError(error) from error


def _first_repeated(values: Iterable[Value]) -> Value | None:
    seen: set[tuple[bool, Value]] = set()
    for value in values:
        mark = (isinstance(value, bool), value)  # True and 1 are different settings
        if mark in seen:
            return value
        seen.add(mark)
    return None


def _first_line(error: ValidationError) -> str:
    details = most_telling(error)
    location = [str(part) for part in details["loc"] if not _is_a_type(part)]
    key = ".".join(location)
    if details["type"] == "extra_forbidden":
        exist = [field.alias or name for name, field in StudyTable.model_fields.items()]
        return f"unknown key '{key}'; {did_you_mean(key, exist)}keys that exist: {', '.join(exist)}"
    if details["type"] == "missing":
        return f"key '{key}' is missing"
    if location[0] == "seeds":
        return 'seeds: a range such as "1-30", or a list such as [1, 2, 5], expected'
    if location[0] in ("set", "vary") and len(location) > 1:
        what = "a list of numbers, texts or truth values" if location[0] == "vary" else "a value"
        return f"key '{location[0]}.{location[1]}': expected {what}, got {details['input']!r}"
    message = str(details["msg"])
    return f"key '{key}': {message[:1].lower() + message[1:]}, got {details['input']!r}"


def _is_a_type(part: int | str) -> bool:
    """Return whether pydantic names a member of a union here, rather than a key."""
    return part in ("bool", "int", "float", "str", "list[int]")
