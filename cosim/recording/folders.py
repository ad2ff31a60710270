"""Folders of runs; the files of two runs are never mixed."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cosim.errors import InputError

DEFAULT_PARENT = Path("runs")
_UNSAFE = re.compile(r"[^A-Za-z0-9_.=-]+")
"""Characters that addresses of controllers may contain and names of folders should not."""


def check(out: Path | None, flag: str = "--out") -> None:
    """Refuse a folder that cannot take a new run, before anything expensive happens.

    Raises
    ------
    InputError
        If ``out`` is a file, or a folder that is not empty; the message names ``flag``.
    """
    if out is None:
        return
    check_links(out, flag)
    try:
        if out.is_dir():
            if any(out.iterdir()):
                raise InputError(f"{flag} {out}: expected an empty or new folder, this one has files in it")
        elif out.exists():
            raise InputError(f"{flag} {out}: expected a folder, this is a file")
    except OSError as error:
        raise InputError(f"{flag} {out}: {error.strerror}") from error


def check_links(out: Path, flag: str = "--out") -> None:
    """Refuse a folder that is, or is below, a broken link.

    Raises
    ------
    InputError
        If there is such a link; the message names it and its target.
    """
    for place in (out, *out.parents):
        if place.is_symlink() and not place.exists():
            what = "this" if place == out else str(place)
            raise InputError(
                f"{flag} {out}: expected a folder, {what} is a link to {place.readlink()}, which is not there"
            )


def create(out: Path | None, scenario: str, controller: str, seed: int) -> Path:
    """Make the run's folder: ``out``, or the first free ``runs/<scenario>-<controller>-<seed>-<n>``."""
    return create_named(out, f"{scenario}-{plain(controller)}-{seed}")


def plain(controller: str) -> str:
    """Return a controller's name or address as part of a folder's name, without slashes and blanks.

    >>> plain("../../patient.py"), plain("vo_mpc")
    ('patient.py', 'vo_mpc')
    """
    return _UNSAFE.sub("_", controller).strip("._")


def create_named(out: Path | None, name: str) -> Path:
    """Make a folder: ``out``, or the first free ``runs/<name>-<n>``."""
    check(out)
    try:
        if out is not None:
            out.mkdir(parents=True, exist_ok=True)
            return out
        DEFAULT_PARENT.mkdir(exist_ok=True)
        number = 1
        while True:
            folder = DEFAULT_PARENT / f"{name}-{number}"
            try:
                folder.mkdir()
            except FileExistsError:
                number += 1
            else:
                return folder
    except OSError as error:
        raise InputError(f"cannot make the folder {out or DEFAULT_PARENT}: {error.strerror}") from error


@contextmanager
def left_as_it_was(folder: Path, existed: bool) -> Iterator[None]:
    """Remove what was written to a new or empty folder if the input turns out to be bad.

    Parameters
    ----------
    folder
    existed : whether the folder existed before; it is kept then

    Raises
    ------
    InputError
        The error that was raised within the context.
    """
    empty = not folder.is_dir() or not any(folder.iterdir())
    try:
        yield
    except InputError:
        if empty and folder.is_dir():
            shutil.rmtree(folder)
            if existed:
                folder.mkdir()
        raise


def discard(folder: Path) -> None:
    """Remove the folder of a run that never made a step, with the files that this tool wrote there."""
    for path in folder.iterdir():
        path.unlink()
    folder.rmdir()
