"""``python -m studies.methods OUT``: all study files of this folder in turn; repeat it to resume.

``--busy`` runs the middle level of demand alone, ``--seeds 9301`` other seeds than the files say. What was
run is written into each study's folder.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from cosim.batches.batch import BatchRequest, prepared
from cosim.batches.progress import shown_checks, shown_tally
from cosim.batches.study import StudyTable, read_study
from cosim.errors import CosimError

FILES = sorted(Path(__file__).parent.glob("*.toml"))
"""Those that are run unless others are named."""


def narrowed(table: StudyTable, busy: bool, seeds: str | None) -> StudyTable:
    """Return a study with the middle of the levels of demand alone, and with other seeds."""
    changes: dict[str, object] = {}
    if busy:
        changes["vary"] = {key: [values[len(values) // 2]] for key, values in table.vary.items()}
    if seeds is not None:
        changes["seeds"] = seeds
    return table.model_copy(update=changes)


def main(arguments: list[str]) -> int:
    """Run them; 0 if every run is valid."""
    parser = argparse.ArgumentParser(prog="studies.methods", description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("files", type=Path, nargs="*", metavar="STUDY.toml")
    parser.add_argument("--busy", action="store_true", help="the middle level of demand alone")
    parser.add_argument("--seeds", help="for instance 9301-9305")
    parser.add_argument("--jobs", type=int, help="runs at a time")
    given = parser.parse_args(arguments)
    again = " ".join(["python -m studies.methods", *arguments])
    good = True
    for file in given.files or FILES:
        table = narrowed(read_study(file), given.busy, given.seeds)
        request = BatchRequest(file, given.out / file.stem, given.jobs, table=table, again=again)
        try:
            with prepared(request, shown_checks()) as batch:
                good &= batch.run(shown_tally()).good
        except CosimError as problem:
            print(f"methods: {problem}", file=sys.stderr)
            return 2
    return 0 if good else 3


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
