"""``python -m studies.zoo``: ``all`` makes and drives the zoo, ``one`` repeats one run of it.

    python -m studies.zoo all 7                drives every network of seed 7 and prints the tables
    python -m studies.zoo all 7 --quick        eight networks, a short run each
    python -m studies.zoo one 7 grid-short --controller vo_mpc --run-seed 3
    python -m studies.zoo list                 the networks that there are

``all`` goes on where it was interrupted. Exit codes: 0 all runs are valid, 2 bad input, 3 a run failed.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from analysis.files import read_json, write_text
from cosim.batches.identity import source_digest
from cosim.recording.folders import DEFAULT_PARENT
from studies.zoo import page, results, tables, town
from studies.zoo.bars import bars
from studies.zoo.catalog import CONTROLLERS, EGO_SHARE, QUICK, Plan, all_recipes, chosen
from studies.zoo.driving import TOWN, Limits, cosim, drive, environment, is_done
from studies.zoo.programs import ZooError
from studies.zoo.recipe import Recipe
from studies.zoo.results import Run
from studies.zoo.tally import of

PLAN = "zoo.json"
"""File that says how the results of a folder were made."""
QUICK_DURATION_S = 100.0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit code."""
    given, more = _parser().parse_known_args(arguments)
    try:
        if more and given.command != "one":
            raise ZooError(f"unknown: {' '.join(more)}; --help lists what there is")
        if given.command == "list":
            return _list()
        return _one(given, more) if given.command == "one" else _all(given)
    except ZooError as error:
        print(f"zoo: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("zoo: interrupted; the same command goes on", file=sys.stderr)
        return 130


def _list() -> int:
    recipes, missing = all_recipes()
    for recipe in recipes:
        print(f"{recipe.name:24}{recipe.what}")
    for line in missing:
        print(line)
    return 0


def _one(given: argparse.Namespace, more: Sequence[str]) -> int:
    """Make one network and one run on it with ``cosim run``."""
    (recipe,) = chosen([given.network])
    name = f"{given.seed}-{recipe.name}-{given.controller}-{given.run_seed}"
    folder: Path = given.out or DEFAULT_PARENT / "zoo-one" / name
    if (folder / "run").exists():
        raise ZooError(f"{folder / 'run'} is there already; remove it, or give another --out")
    shutil.rmtree(folder / TOWN, ignore_errors=True)  # it may be one for another duration
    configuration = town.make(recipe, given.seed, given.duration_s, folder / TOWN)
    words = ["run", str(configuration), "--controller", given.controller, "--seed", str(given.run_seed)]
    words += ["--ego-share", f"{given.ego_share:g}", "--duration-s", f"{given.duration_s:g}"]
    words += ["--out", str(folder / "run"), *more]
    return subprocess.run(cosim(*words), env=environment(), check=False).returncode


def _all(given: argparse.Namespace) -> int:
    """Drive the zoo, print its tables and write its page."""
    plan = Plan(
        given.seed,
        given.duration_s or (QUICK_DURATION_S if given.quick else Plan(0).duration_s),
        given.runs or (1 if given.quick else Plan(0).runs),
        given.ego_share,
        tuple(given.controllers.split(",")),
    )
    everything, missing = all_recipes()
    names = given.networks.split(",") if given.networks else QUICK if given.quick else ()
    recipes = chosen(names) if names else everything
    folder: Path = given.out or DEFAULT_PARENT / "zoo" / f"{plan.seed}{'-quick' if given.quick else ''}"
    sources = {name: source_digest(name) for name in plan.controllers}
    _claim(folder, plan, recipes, sources)
    for line in missing:
        print(line)
    limits = Limits(given.jobs, given.run_timeout_s, given.keep_recordings)
    runs: list[Run] = []
    for number, recipe in enumerate(recipes, 1):
        place = folder / recipe.name
        if given.again and is_done(place):
            shutil.rmtree(place)
        if not is_done(place):
            drive(recipe, plan, limits, place)
        found = results.read(recipe, plan, place)
        _tell(f"[{number}/{len(recipes)}] {recipe.name}", found, plan)
        runs += found
    tables.write(folder, runs)
    text = page.text(recipes, plan, runs, missing, _command(given), sources)
    target: Path = given.page or folder / "zoo.md"
    write_text(target, text)
    print(f"\n{tables.pooled(runs, plan.controllers)}\n")
    print(tables.bars_table(bars(runs, [recipe.name for recipe in recipes if recipe.as_it_is])))
    print(f"\npage: {target}; tables: {folder}/*.csv")
    return 0 if all(run.valid for run in runs) else 3


def _command(given: argparse.Namespace) -> str:
    """Return the command that makes the same results."""
    usual, asked = vars(_parser().parse_args(["all", str(given.seed)])), vars(given)
    names = ("networks", "controllers", "runs", "duration_s", "ego_share")
    words = [f"--{name.replace('_', '-')} {asked[name]}" for name in names if asked[name] != usual[name]]
    if not words:
        return f"make zoo SEED={given.seed}{' QUICK=1' if given.quick else ''}"
    return " ".join([f"python -m studies.zoo all {given.seed}", *["--quick"] * given.quick, *words])


def _claim(folder: Path, plan: Plan, recipes: Sequence[Recipe], sources: Mapping[str, str]) -> None:
    """Refuse a folder whose results were made differently from how they would be made now."""
    now = {
        **asdict(plan),
        "networks": [recipe.name for recipe in recipes],
        "source": sources,
    }
    now = json.loads(json.dumps(now))
    path = folder / PLAN
    if path.exists():
        before = read_json(path)
        differing = [key for key in now if key != "networks" and before.get(key) != now[key]]
        if differing:
            raise ZooError(
                f"{folder} holds results of another {' and '.join(differing)}; "
                "expected the same, or a new folder (--out, or OUT= with make)"
            )
    folder.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(now, indent=1) + "\n", "utf-8")


def _tell(head: str, runs: Sequence[Run], plan: Plan) -> None:
    """Print the results of a network's runs, with a command for each failure and each contact."""
    print(head, flush=True)
    for controller in plan.controllers:
        tally = of(runs, controller)
        largest = tally.largest_impact_kmh
        print(
            f"  {controller}: {len(tally.valid)} of {len(tally.runs)} runs valid, {tally.entered} entered, "
            f"{len(tally.contacts)} contacts ({tally.preventable} preventable"
            + (f", up to {largest:.1f} km/h)" if largest is not None else ")")
        )
        for run in tally.runs:
            if run.reason:
                print(f"    failed: {run.reason}\n      {run.command}")
            for one in run.contacts:
                speed = "" if one.impact_kmh is None else f" with {one.impact_kmh:.1f} km/h"
                when = "" if one.time_s is None else f" at {one.time_s:.1f} s"
                print(f"    contact: ego {one.ego}, person {one.person}{when}{speed}\n      {run.command}")
    sys.stdout.flush()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.zoo",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    whole = commands.add_parser("all", help="drive the zoo")
    whole.add_argument("seed", type=int, help="of networks and demand")
    whole.add_argument("--quick", action="store_true", help="a few networks, short runs")
    whole.add_argument("--networks", help="these only, separated by commas")
    whole.add_argument("--controllers", default=",".join(CONTROLLERS), help="separated by commas")
    whole.add_argument("--runs", type=int, help="of each controller on each network")
    whole.add_argument("--duration-s", type=float, help="simulated time of a run [s]")
    whole.add_argument("--ego-share", type=float, default=EGO_SHARE, help="share of the passenger cars")
    whole.add_argument("--jobs", type=int, default=2, help="runs at a time")
    whole.add_argument("--run-timeout-s", type=float, default=Limits().run_timeout_s, help="of each run [s]")
    whole.add_argument("--keep-recordings", action="store_true", help="they take about 20 MB a run")
    whole.add_argument("--again", action="store_true", help="make finished networks once more")
    whole.add_argument("--out", type=Path, help="folder of the results")
    whole.add_argument("--page", type=Path, help="file of the page")
    one = commands.add_parser("one", help="repeat one run; other options go to cosim run")
    one.add_argument("seed", type=int, help="of the zoo")
    one.add_argument("network", help="name of the network")
    one.add_argument("--controller", default=CONTROLLERS[0])
    one.add_argument("--run-seed", type=int, default=1)
    one.add_argument("--duration-s", type=float, default=Plan(0).duration_s, help="simulated time [s]")
    one.add_argument("--ego-share", type=float, default=EGO_SHARE, help="share of the passenger cars")
    one.add_argument("--out", type=Path, help="new folder")
    commands.add_parser("list", help="show the networks")
    return parser


if __name__ == "__main__":
    sys.exit(main())
