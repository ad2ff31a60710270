"""Writes the report of runs as a web page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from analysis.errors import AnalysisError
from cosim.errors import InputError
from cosim.presentation.notes import unverified
from cosim.presentation.wording import sentence
from cosim.recording.folders import check_links, create_named


def write_page(
    folders: list[Path],
    out: Path | None = None,
    base: str | None = None,
    rows: int = 200,
    replays: int = 100,
) -> tuple[Path, list[str], Mapping[Path, str]]:
    """Write the page; return its path, notes to print, and the damaged runs with what is wrong.

    Raises
    ------
    InputError
        If the runs cannot be read, the page cannot be written, or a required package is missing.
    """
    try:
        from analysis.page.report import write_report
    except ModuleNotFoundError as error:
        raise _unavailable(error) from error
    if out is None:
        out = folders[0] if len(folders) == 1 else create_named(None, "report")
    check_links(out)
    title = out.resolve().name if len(folders) == 1 else ", ".join(folder.name for folder in folders)
    try:
        written = write_report(folders, out, sentence, title=title, baseline=base, rows=rows, replays=replays)
    except AnalysisError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"{out}: the report cannot be written: {error.strerror}") from error
    notes = [
        f"{written.listed} encounter{'s' * (written.listed != 1)} listed, {written.replays} with a replay"
    ]
    if written.not_recorded:
        notes.append(
            f"{written.not_recorded} of them have no recording to replay; "
            "the page gives the command that records each"
        )
    notes += unverified(run.folder for run in written.runs if run.valid)
    return written.page, notes, written.unreadable


def _unavailable(error: ModuleNotFoundError) -> Exception:
    """Return an error that says which packages to install."""
    return InputError(f"{error.name} is not installed; run: pip install matplotlib Jinja2")
