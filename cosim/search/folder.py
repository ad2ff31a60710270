"""The folder of a search or an estimate, which records what determines its runs, so that they can resume."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from analysis.files import write_text
from cosim.batches.study import toml_value
from cosim.errors import InputError
from cosim.search.subject import Subject

ABOUT = "search.toml"


def described(title: str, subject: Subject, asked: Mapping[str, Any], settings: Mapping[str, str]) -> str:
    """Return all that determines the runs, as TOML.

    Parameters
    ----------
    title
        First line.
    subject
    asked
        Numbers and names of the request.
    settings
        Settings as given after ``--set``.
    """
    content: dict[str, Any] = {
        "scenario": subject.scenario,
        "controller": subject.controller,
        **asked,
        "set": dict(settings),
        "criteria": [
            f"{one.id}: {one.scope} {one.metric} {one.operator} {one.threshold:g}" for one in subject.criteria
        ],
    }
    lines = [f"# {title}", *(f"{key} = {toml_value(value)}" for key, value in content.items())]
    table = subject.space.table.model_dump(exclude_unset=True, exclude_none=True)
    lines += [f"space.{name} = {toml_value(one)}" for name, one in table.items()]
    return "\n".join(lines) + "\n"


def check_folder(folder: Path, about: str) -> None:
    """Refuse a folder that holds another search or other files.

    Raises
    ------
    InputError
        If it does; names the first difference.
    """
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError(f"--out {folder}: expected a folder, this is a file")
    file = folder / ABOUT
    if not file.is_file():
        if any(folder.iterdir()):
            raise InputError(
                f"--out {folder}: expected an empty or new folder, or the one of this search; "
                "this one has other files in it"
            )
        return
    before, now = file.read_text(encoding="utf-8").splitlines(), about.splitlines()
    if before != now:
        differs = next((one for one in now if one not in before), "")
        was = next((one for one in before if one not in now), "")
        raise InputError(
            f"--out {folder} belongs to another search: there {_cut(was)}, here {_cut(differs)}; "
            "expected the same search, or a new folder"
        )


def begin(folder: Path, about: str) -> None:
    """Make the folder, and write down all that determines its runs.

    Raises
    ------
    InputError
        If the folder cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_text(folder / ABOUT, about)
    except OSError as error:
        raise InputError(f"--out {folder}: {error.strerror}") from error


def _cut(line: str, longest: int = 120) -> str:
    return line if len(line) <= longest else f"{line[:longest]}…"
