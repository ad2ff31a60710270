"""The tables of a study, from its finished runs."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from threading import Thread

from cosim.batches.ledger import Ledger
from cosim.errors import SimulationError, reason_of

USUAL_BASELINE = "sumo"


def get_ready() -> None:
    """Begin to load, beside everything else, what `write` needs: statistics take more than a second."""
    Thread(target=importlib.import_module, args=("analysis.study.writing",), daemon=True).start()


def write(ledger: Ledger, controllers: Sequence[str]) -> None:
    """Write ``runs.csv``, ``encounters.csv``, ``configs.csv``, ``comparisons.csv`` and ``failed.csv``.

    Raises
    ------
    SimulationError
        If that is not possible.
    """
    from analysis.study.writing import write_tables  # statistics, which a dry run does not need

    baseline = USUAL_BASELINE if USUAL_BASELINE in controllers else controllers[0]
    folders = ledger.recorded()
    try:
        ledger.write_failures()
        if folders:
            write_tables(ledger.folder, folders, baseline)
    except (OSError, ValueError) as error:
        raise SimulationError(
            f"{ledger.folder}: the tables could not be written: {reason_of(error)}"
        ) from error
