"""``python -m studies.methods OUT``: every study of the methods, seed after seed; repeat it to resume.

The order is that of a study which may be stopped at any time: seed by seed, within a seed level by level of
demand, within a level scenario by scenario, and in a scenario every method. ``--levels busy`` runs some
levels alone, ``--seeds 9301`` other seeds than the files say. ``plan.json`` in the folder says how many runs
the whole has, so that the page can say what it rests on.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from analysis.files import read_json, write_json
from cosim.batches.batch import BatchRequest, prepared
from cosim.batches.progress import shown_checks, shown_tally
from cosim.batches.study import StudyTable, parse_seeds, read_study
from cosim.errors import CosimError
from studies.methods import untuned
from studies.zoo.programs import ZooError

FOLDER = Path(__file__).parent
FILES = (*sorted(FOLDER.glob("*.toml")), Path(untuned.NAME))
"""What is run by default: study files, and the network that nobody tuned for."""
LEVELS = tuple(untuned.LEVELS)
"""Levels of demand, in the order in which study files vary it."""
ORDER = ("busy", "light", "crowded")
"""Order in which the levels are run."""
PLAN = "plan.json"
"""File in the study's folder that describes the whole study."""

Block = tuple[str, str]
"""A level of demand and the name of a study."""


def at_level(table: StudyTable, level: str) -> StudyTable:
    """Return a study with only one of its levels of demand."""
    vary = {key: [values[LEVELS.index(level)]] for key, values in table.vary.items()}
    return table.model_copy(update={"vary": vary})


def studies(
    out: Path, files: Sequence[Path], levels: Sequence[str], seeds: str | None
) -> dict[Block, StudyTable]:
    """Return the studies to run, in their order for one seed.

    Parameters
    ----------
    out : folder of the generated networks
    files : study files, or the name of the network that nobody tuned for
    levels : levels of demand
    seeds : seeds that replace those of the files

    Raises
    ------
    CosimError, ZooError
        If a study file is not valid, or a network could not be made.
    """
    tables = {file.stem: read_study(file) for file in files if file.name != untuned.NAME}
    made: dict[str, StudyTable] = {}
    if len(tables) < len(files):
        like = read_study(FOLDER / "midblock_zebra.toml")
        made = untuned.tables(out, like.controllers, like.seeds, levels)
    changed = {} if seeds is None else {"seeds": seeds}
    found: dict[Block, StudyTable] = {}
    for level in [one for one in ORDER if one in levels]:
        for name, table in tables.items():
            found[level, name] = at_level(table, level).model_copy(update=changed)
        if level in made:
            found[level, untuned.NAME] = made[level].model_copy(update=changed)
    return found


def batches(out: Path, tables: dict[Block, StudyTable]) -> Iterator[tuple[Path, StudyTable]]:
    """Yield the folder and the table of each batch: one seed of one study at one level, seeds outermost."""
    seeds = {seed: None for table in tables.values() for seed in parse_seeds(table.seeds)}
    for seed in seeds:
        for (level, name), table in tables.items():
            if seed in parse_seeds(table.seeds):
                yield out / f"seed_{seed}" / level / name, table.model_copy(update={"seeds": [seed]})


def write_plan(out: Path, tables: dict[Block, StudyTable]) -> None:
    """Write how many runs each batch of the whole study has; earlier plans are kept."""
    path = out / PLAN
    before = read_json(path)["runs"] if path.exists() else {}
    runs = {
        folder.relative_to(out).as_posix(): len(table.controllers) for folder, table in batches(out, tables)
    }
    out.mkdir(parents=True, exist_ok=True)
    write_json(path, {"runs": {**before, **runs}})


def main(arguments: list[str]) -> int:
    """Run the studies of a command line; return 0 if every run is valid."""
    parser = argparse.ArgumentParser(prog="studies.methods", description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("files", type=Path, nargs="*", metavar="STUDY.toml", help=f"or {untuned.NAME}")
    parser.add_argument(
        "--levels", nargs="+", choices=LEVELS, default=LEVELS, metavar="LEVEL", help=f"of {', '.join(LEVELS)}"
    )
    parser.add_argument("--seeds", help="for instance 9301-9305")
    parser.add_argument("--jobs", type=int, help="runs at a time")
    given = parser.parse_args(arguments)
    again = " ".join(["python -m studies.methods", *arguments])
    good = True
    try:
        files = given.files or FILES
        write_plan(given.out, studies(given.out, files, LEVELS, None))
        tables = studies(given.out, files, given.levels, given.seeds)
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
