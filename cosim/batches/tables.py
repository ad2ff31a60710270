"""Writes the tables of a study from its finished runs."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from threading import Thread

from analysis.sealing import seal_tables
from cosim.batches.ledger import FAILURES, Ledger
from cosim.errors import SimulationError, reason_of

TABLES = (
    *(
        "runs.csv",
        "encounters.csv",
        "traffic_encounters.csv",
        "crossing_exposure.csv",
        "configs.csv",
        "comparisons.csv",
    ),
    *("datapackage.json", FAILURES),
)
"""Files of a study that have hashes."""
USUAL_BASELINE = "sumo"


def get_ready() -> None:
    """Begin to load the modules that `write` needs in a thread, as statistics take more than a second."""
    Thread(target=importlib.import_module, args=("analysis.study.writing",), daemon=True).start()


def write(ledger: Ledger, controllers: Sequence[str]) -> dict[str, str]:
    """Write ``runs.csv``, ``encounters.csv``, ``configs.csv``, ``comparisons.csv`` and ``failed.csv``.

    Returns
    -------
    dict
        Runs that are left out because they cannot be read, by name: which file, and the remedy.

    Raises
    ------
    SimulationError
        If the tables cannot be written.
    """
    from analysis.study.writing import write_tables  # statistics, which a dry run does not need

    baseline = USUAL_BASELINE if USUAL_BASELINE in controllers else controllers[0]
    folders = ledger.recorded()
    try:
        damaged = ledger.write_failures()
        unreadable = write_tables(ledger.folder, folders, baseline) if folders else {}
        seal_tables(ledger.folder, [path for name in TABLES if (path := ledger.folder / name).is_file()])
        return damaged | {ledger.name_of(folder): told for folder, told in unreadable.items()}
    except (OSError, ValueError) as error:
        raise SimulationError(
            f"{ledger.folder}: the tables could not be written: {reason_of(error)}"
        ) from error
