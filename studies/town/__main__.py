"""``python -m studies.town FOLDER``: makes the town and screens it.

The town is the largest network with crossings among SUMO's games; cars and people are those of
``randomTrips.py``. Repeat the command to resume.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from analysis.screening.ranking import BY_RISK
from cosim.batches.batch import prepared
from cosim.batches.progress import shown_checks, shown_tally
from cosim.errors import CosimError
from cosim.screening.screen import ScreenRequest, planned, ranked
from studies.zoo import town
from studies.zoo.collected import recipes
from studies.zoo.programs import ZooError

RECIPE, DEMAND_SEED = "game-drt", 1
SCREENING, TOWN = "screening", "town"


def main(words: Sequence[str] | None = None) -> int:
    """Make the missing runs and rank the crossings; return 0 if all runs are good, else 3."""
    parser = argparse.ArgumentParser(prog="python -m studies.town", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seeds", default="9801-9810")
    parser.add_argument("--minutes", type=float, default=20.0, help="that count, in each run")
    parser.add_argument(
        "--begin-s", type=float, default=240.0, help="cars and people fill the town until then"
    )
    parser.add_argument("--step-s", default="0.2")
    parser.add_argument("--min-pedestrians", type=float, default=30.0, help="as for cosim screen")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args(words)
    recipe = next(one for one in recipes()[0] if one.name == RECIPE)
    end = given.begin_s + 60.0 * given.minutes
    configuration = town.make(recipe, DEMAND_SEED, end, given.folder / TOWN)
    request = ScreenRequest(
        str(configuration),
        given.seeds,
        {"step_s": given.step_s},
        given.begin_s,
        end,
        given.folder / SCREENING,
        given.jobs,
    )
    with prepared(planned(request).batch, shown_checks()) as batch:
        result = batch.run(shown_tally())
    if result.tally.done:
        ranked(request, given.min_pedestrians, BY_RISK)
    return 0 if result.good else 3


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (CosimError, ZooError) as problem:
        sys.exit(f"town: {problem}")
