"""``python -m studies.planted FOLDER``: screens the towns of all variants.

Replications are made in blocks, one screening of each variant for each block, so that an interrupted study
resumes and one of fewer replications can be enlarged: repeat the command, with a larger number.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from cosim.batches.batch import prepared
from cosim.batches.progress import shown_checks, shown_tally
from cosim.errors import CosimError
from cosim.screening.screen import ScreenRequest, planned
from studies.planted.outcomes import BLOCK, FIRST_SEED, RUNS, block_folder
from studies.planted.town import DEFECTS, write_town


def main(words: Sequence[str] | None = None) -> int:
    """Make the missing replications; return 0 if all runs are good, else 3."""
    parser = argparse.ArgumentParser(prog="python -m studies.planted", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--replications", type=int, default=50, help=f"made in blocks of {BLOCK}")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args(words)
    blocks = -(-given.replications // BLOCK)
    good = True
    for block in range(blocks):
        for defect in DEFECTS:
            town = write_town(defect, given.folder / "towns" / defect.name)
            first = FIRST_SEED + block * BLOCK * RUNS
            seeds = f"{first}-{first + BLOCK * RUNS - 1}"
            out = block_folder(given.folder, defect, block)
            request = ScreenRequest(str(town), seeds, out=out, jobs=given.jobs)
            with prepared(planned(request).batch, shown_checks()) as batch:
                result = batch.run(shown_tally())
            print(f"{defect.name}, block {block + 1} of {blocks}: {result.tally.done} runs", flush=True)
            if result.stopped:
                return 3
            good = good and result.good
    return 0 if good else 3


if __name__ == "__main__":
    try:
        sys.exit(main())
    except CosimError as problem:
        sys.exit(f"planted: {problem}")
