"""``python -m studies.methods OUT``: every study of the methods, seed after seed; repeat it to resume.

All studies are run with the first seed, then with the next, so that what is finished is comparable whenever
it is stopped. ``--busy`` runs the middle level of demand alone, ``--seeds 9301`` other seeds than the files
say. What was run is written into each study's folder.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from cosim.batches.batch import BatchRequest, prepared
from cosim.batches.progress import shown_checks, shown_tally
from cosim.batches.study import StudyTable, parse_seeds, read_study
from cosim.errors import CosimError
from studies.methods import untuned
from studies.zoo.programs import ZooError

FOLDER = Path(__file__).parent
FILES = (*sorted(FOLDER.glob("*.toml")), Path(untuned.NAME))
"""What is run unless others are named: study files, and the network that nobody tuned for."""
BUSY = "busy"
"""The middle level of demand."""


def narrowed(table: StudyTable, busy: bool) -> StudyTable:
    """Return a study, with the middle of the levels of demand alone if asked for."""
    if not busy:
        return table
    vary = {key: [values[len(values) // 2]] for key, values in table.vary.items()}
    return table.model_copy(update={"vary": vary})


def studies(out: Path, files: Sequence[Path], busy: bool, seeds: str | None) -> dict[str, StudyTable]:
    """Return what is run, by name.

    Parameters
    ----------
    out : where generated networks lie
    files : study files, or the name of the network that nobody tuned for
    busy : whether the middle level of demand alone
    seeds : instead of those of the files

    Raises
    ------
    CosimError, ZooError
        A study file that is not valid; a network that could not be made.
    """
    found: dict[str, StudyTable] = {}
    levels = [BUSY] if busy else list(untuned.LEVELS)
    for file in files:
        if file.name != untuned.NAME:
            found[file.stem] = narrowed(read_study(file), busy)
            continue
        like = read_study(FOLDER / "midblock_zebra.toml")
        found |= untuned.tables(out, like.controllers, like.seeds, levels)
    changed = {} if seeds is None else {"seeds": seeds}
    return {name: table.model_copy(update=changed) for name, table in found.items()}


def batches(out: Path, tables: dict[str, StudyTable]) -> Iterator[tuple[Path, StudyTable]]:
    """Yield the folder and the table of each batch: one seed of one study, seeds outermost."""
    seeds = {seed: None for table in tables.values() for seed in parse_seeds(table.seeds)}
    for seed in seeds:
        for name, table in tables.items():
            if seed in parse_seeds(table.seeds):
                yield out / f"seed_{seed}" / name, table.model_copy(update={"seeds": [seed]})


def main(arguments: list[str]) -> int:
    """Run them; 0 if every run is valid."""
    parser = argparse.ArgumentParser(prog="studies.methods", description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("files", type=Path, nargs="*", metavar="STUDY.toml", help=f"or {untuned.NAME}")
    parser.add_argument("--busy", action="store_true", help="the middle level of demand alone")
    parser.add_argument("--seeds", help="for instance 9301-9305")
    parser.add_argument("--jobs", type=int, help="runs at a time")
    given = parser.parse_args(arguments)
    again = " ".join(["python -m studies.methods", *arguments])
    good = True
    try:
        tables = studies(given.out, given.files or FILES, given.busy, given.seeds)
        for folder, table in batches(given.out, tables):
            name = Path(f"{folder.name}.toml")
            request = BatchRequest(name, folder, given.jobs, table=table, again=again)
            with prepared(request, shown_checks()) as batch:
                good &= batch.run(shown_tally()).good
    except (CosimError, ZooError) as problem:
        print(f"methods: {problem}", file=sys.stderr)
        return 2
    return 0 if good else 3


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
