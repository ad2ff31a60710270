"""Draws a recorded run as figures, and one of its encounters as a film."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from analysis.errors import AnalysisError
from cosim.errors import InputError
from cosim.presentation.pictures import FORMATS, check_picture, require_matplotlib
from cosim.recording import folders


def write_figures(
    folder: Path, ego: str | None, encounter: int | None, out: Path | None, kind: str
) -> list[Path]:
    """Draw the trip of an ego, or one encounter, and return the files.

    Parameters
    ----------
    folder : folder of the run
    ego : ego whose trip is drawn; ``None`` for the first ego
    encounter : number of the encounter; ``None`` for the whole trip
    out : empty or new folder; ``None`` for ``plots`` in that of the run
    kind : format of the files, one of `FORMATS`

    Raises
    ------
    InputError
        If the input is bad, the folder cannot be written to, or matplotlib is not installed.
    """
    require_matplotlib("cosim plot")
    if kind not in FORMATS:
        raise InputError(f"--format: expected {' or '.join(FORMATS)}, got {kind!r}")
    folders.check(out)
    # The modules that draw are loaded only now that matplotlib is known to be installed.
    from analysis.encounters.recorded_case import read_case
    from analysis.plots.figures import draw_figures
    from analysis.plots.scene import choose

    target = folder / "plots" if out is None else out
    with _as_input_errors(f"cannot write to {target}"):
        return draw_figures(choose(read_case(folder), ego, encounter), target, kind)


def write_replay(folder: Path, encounter: int, out: Path) -> int:
    """Write an encounter as a film, and return the number of its frames.

    Parameters
    ----------
    folder : folder of the run
    encounter : number of the encounter
    out : file of the film; its suffix decides the format

    Raises
    ------
    InputError
        If the input is bad, the file cannot be written, or matplotlib or what the format needs is missing.
    """
    require_matplotlib("cosim replay")
    from analysis.encounters.recorded_case import read_case
    from analysis.plots import animation
    from analysis.plots.scene import choose

    check_picture(out, animation.FORMATS)
    if out.suffix.lower() == ".mp4" and not animation.has_ffmpeg():
        raise InputError(f"{out}: .mp4 needs ffmpeg, which is not installed; use .gif instead")
    with _as_input_errors(f"cannot write {out}"):
        return animation.write_film(choose(read_case(folder), None, encounter), out)


@contextmanager
def _as_input_errors(what: str) -> Iterator[None]:
    try:
        yield
    except AnalysisError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"{what}: {error.strerror or error}") from error
