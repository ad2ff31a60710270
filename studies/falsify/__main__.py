"""Searches for failures of several controllers on several scenarios with the same budget.

``python -m studies.falsify runs/study-falsify docs/study-falsify.md`` makes the missing searches one after
the other, and writes the page from the finished ones. It may be interrupted and repeated.
"""

from __future__ import annotations

import sys
from pathlib import Path

from cosim.batches.progress import shown_tally
from cosim.errors import CosimError
from cosim.search.search import FalsifyRequest, prepared
from studies.falsify.page import FINISHED, write_page

SCENARIOS = ("jaywalk_arterial", "bus_stop_occlusion", "signalised_junction", "midblock_unmarked")
CONTROLLERS = ("vo_mpc", "aeb", "careful_driver", "sumo", "vo_paper")
BUDGET = 30
SEED = 9301
"""Seed that is used for nothing else."""


def main(folder: Path, page: Path) -> None:
    """Make the missing searches, and write the page.

    Parameters
    ----------
    folder
        Folder of the searches.
    page
        Markdown file.
    """
    for controller in CONTROLLERS:
        for scenario in SCENARIOS:
            out = folder / controller / scenario
            if not (out / FINISHED).is_file():
                print(f"{controller} on {scenario}", file=sys.stderr, flush=True)
                request = FalsifyRequest(scenario, controller, BUDGET, seed=SEED, out=out, shrink=False)
                prepared(request).run(shown_tally())
            write_page(folder, CONTROLLERS, SCENARIOS, page)


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]), Path(sys.argv[2]))
    except CosimError as error:
        sys.exit(f"falsify: {error}")
