"""The tables of a study, from its finished runs."""

from __future__ import annotations

from collections.abc import Sequence

from analysis.study import write_tables
from cosim.batch.ledger import Ledger
from cosim.errors import SimulationError

USUAL_BASELINE = "sumo"


def write(ledger: Ledger, controllers: Sequence[str]) -> None:
    """Write ``runs.csv``, ``encounters.csv``, ``configs.csv``, ``comparisons.csv`` and ``failed.csv``.

    Raises
    ------
    SimulationError
        If that is not possible.
    """
    baseline = USUAL_BASELINE if USUAL_BASELINE in controllers else controllers[0]
    names = ledger.finished()
    try:
        ledger.write_failures()
        if names:
            write_tables(ledger.folder, [ledger.run_folder(name) for name in names], baseline)
    except (OSError, ValueError) as error:
        raise SimulationError(f"{ledger.folder}: the tables could not be written: {error}") from error
