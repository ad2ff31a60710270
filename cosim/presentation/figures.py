"""A recorded run as figures, and one of its encounters as a film."""

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
    folder : of the run
    ego : whose trip; ``None`` for the first ego's
    encounter : its number; ``None`` for the whole trip
    out : empty or new folder; ``None`` for ``plots`` in that of the run
    kind : of the files, one of `FORMATS`

    Raises
    ------
    InputError
        For bad input, a folder that cannot be written to, and without matplotlib.
    """
    require_matplotlib("cosim plot")
    if kind not in FORMATS:
        raise InputError(f"--format: expected {' or '.join(FORMATS)}, got {kind!r}")
    folders.check(out)
    # What draws is loaded where it is known to be installed.
    from analysis.encounters.case import prepare
    from analysis.plots.figures import draw_figures
    from analysis.plots.scene import choose
    from analysis.recording.reading import read_run

    target = folder / "plots" if out is None else out
    with _as_input_errors(f"cannot write to {target}"):
        return draw_figures(choose(prepare(read_run(folder)), ego, encounter), target, kind)


def write_replay(folder: Path, encounter: int, out: Path) -> int:
    """Write an encounter as a film, and return the number of its frames.

    Parameters
    ----------
    folder : of the run
    encounter : its number
    out : the film; its ending says of what kind

    Raises
    ------
    InputError
        For bad input, a file that cannot be written, and without matplotlib or what that kind needs.
    """
    require_matplotlib("cosim replay")
    from analysis.encounters.case import prepare
    from analysis.plots import animation
    from analysis.plots.scene import choose
    from analysis.recording.reading import read_run

    check_picture(out, animation.FORMATS)
    if out.suffix.lower() == ".mp4" and not animation.has_ffmpeg():
        raise InputError(f"{out}: .mp4 needs ffmpeg, which is not installed; use .gif instead")
    with _as_input_errors(f"cannot write {out}"):
        return animation.write_film(choose(prepare(read_run(folder)), None, encounter), out)


@contextmanager
def _as_input_errors(what: str) -> Iterator[None]:
    try:
        yield
    except AnalysisError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"{what}: {error.strerror or error}") from error
