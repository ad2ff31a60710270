"""Results of each replication: the rank of the planted crossing, and false alarms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.arrays import BoolArray
from analysis.screening.counts import Counts, read_counts
from analysis.screening.crossings_table import WORSE_BELOW
from analysis.screening.ranking import BY_RISK, RANK_BY, rank
from studies.planted.town import PLANTED, Defect, crossing_of

RUNS = 4
"""Runs of a replication, with the seeds of one screening."""
BLOCK = 5
"""Number of replications that are made at once."""
FIRST_SEED = 9601
CHOSEN_ON = 5
"""Number of first replications on which the weights of conflicts were chosen; they do not count."""
LEAST_PEDESTRIANS = 30.0
"""Smallest number of pedestrians for a rank, as in ``cosim screen``."""


def block_folder(folder: Path, defect: Defect, block: int) -> Path:
    """Return the folder with the runs of a block of replications."""
    return folder / defect.name / f"block-{block + 1:02d}"


@dataclass(frozen=True, slots=True)
class Replication:
    """One screening of one town."""

    seed: int
    """Seed of its first run."""
    rank: float
    """Rank of the crossing on the planted street, whether or not a defect is planted there."""
    worse: BoolArray
    """Whether each crossing is called significantly worse."""
    planted: int
    """Index of the planted street's crossing among them."""
    rates: tuple[float, float]
    """Conflicts per pedestrian on the planted crossing, and on all others."""
    pedestrians: float
    """Number of pedestrians on the crossing with the fewest."""

    @property
    def found(self) -> bool:
        """Whether the planted crossing alone ranks first."""
        return self.rank == 1.0

    @property
    def called_worse(self) -> bool:
        """Whether the planted crossing is called significantly worse."""
        return bool(self.worse[self.planted])

    @property
    def false_alarms(self) -> int:
        """Number of other crossings that are called significantly worse."""
        return int(self.worse.sum()) - self.called_worse


def replications(folder: Path, defect: Defect) -> dict[str, list[Replication]]:
    """Return the finished replications of a variant that count, for each measure of ranking.

    Replications with an invalid or missing run are left out, and so are those on which weights were chosen.
    """
    first = FIRST_SEED + CHOSEN_ON * RUNS
    found: dict[str, list[Replication]] = {by: [] for by in RANK_BY}
    for block in sorted((folder / defect.name).glob("block-*")):
        if (block / "runs.csv").is_file():
            counts = read_counts(block)
            for by in RANK_BY:
                found[by].extend(one for one in of_counts(counts, by) if one.seed >= first)
    return found


def of_counts(counts: Counts, by: str = BY_RISK) -> Iterator[Replication]:
    """Yield the complete replications among the runs of a block."""
    names = [cells["crossing_id"] for cells in counts.crossings]
    planted = names.index(crossing_of(PLANTED))
    column = {seed: number for number, seed in enumerate(counts.seeds)}
    first = min(counts.seeds) - (min(counts.seeds) - 1) % RUNS
    for begin in range(first, max(counts.seeds) + 1, RUNS):
        chosen = [column[seed] for seed in range(begin, begin + RUNS) if seed in column]
        if len(chosen) == RUNS:
            conflicts, walks = counts.each["conflicts"][:, chosen], counts.each["n_pedestrians"][:, chosen]
            ranking = rank(counts.counted(chosen), LEAST_PEDESTRIANS, by)
            others = np.arange(len(names)) != planted
            yield Replication(
                begin,
                float(ranking.rank[planted]),
                np.asarray(ranking.p_worse < WORSE_BELOW),
                planted,
                (
                    float(conflicts[planted].sum() / walks[planted].sum()),
                    float(conflicts[others].sum() / walks[others].sum()),
                ),
                float(walks.sum(axis=1).min()),
            )
