"""The case of a run's folder, as it was analysed last: other thresholds would number its encounters anew."""

from __future__ import annotations

from pathlib import Path

from analysis.encounters.case import Case, prepare, prepare_traffic
from analysis.errors import DamageError, RecordingError
from analysis.files import read_json
from analysis.recording.reading import read_run
from analysis.recording.traffic import Traffic
from analysis.thresholds import Thresholds, names


def read_case(folder: Path, *, traffic: bool = False) -> Case:
    """Return the case of a recorded run, with the thresholds that its tables were made with.

    Parameters
    ----------
    folder : folder of the run
    traffic : whether every vehicle but the egos takes the place of an ego; the run must have recorded them

    Raises
    ------
    RecordingError
        If the recording cannot be read.
    """
    run, thresholds = read_run(folder), _thresholds(folder)
    return prepare_traffic(Traffic(run).whole(), thresholds) if traffic else prepare(run, thresholds)


def _thresholds(folder: Path) -> Thresholds:
    path = folder / "config.json"
    try:
        stored = read_json(path).get("thresholds") or {}
    except FileNotFoundError:
        stored = {}
    except DamageError:
        raise
    except (OSError, ValueError) as error:
        raise RecordingError(f"{path}: cannot be read ({error})") from None
    known = set(names())
    return Thresholds(**{name: float(value) for name, value in stored.items() if name in known})
