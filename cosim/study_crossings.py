"""``make study-crossings``: controllers at mid-block crossings, on the same seeds. A plain loop of runs.

A run that is done already is not run again, so the study can be stopped and resumed. It writes
``study.csv`` and ``study.md`` into its folder.
"""

from __future__ import annotations

import itertools
import os
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated

import typer

SCENARIOS = "midblock_zebra,midblock_unmarked"
CONTROLLERS = "vo_mpc,sumo,aeb"


def run_one(
    folder: str, scenario: str, controller: str, seed: int, settings: dict[str, str]
) -> tuple[str, str]:
    """Run in a process of its own; return the folder and why it is not valid, empty when it is."""
    from cosim.errors import CosimError
    from cosim.execution import execute
    from cosim.request import RunRequest

    try:
        outcome = execute(RunRequest(scenario, controller, seed, settings, out=Path(folder)))
    except CosimError as error:
        return folder, str(error)
    return folder, outcome.invalid_reason


def study(
    out: Annotated[Path, typer.Option(help="Folder of the study; runs already in it are kept.")] = Path(
        "runs/study-crossings"
    ),
    scenarios: Annotated[str, typer.Option(help="Comma-separated.")] = SCENARIOS,
    controllers: Annotated[str, typer.Option(help="Comma-separated.")] = CONTROLLERS,
    seeds: Annotated[str, typer.Option(help="First and last seed.")] = "9101-9104",
    vehicles: Annotated[
        str, typer.Option(help="Vehicles per hour and direction, comma-separated.")
    ] = "600,1000",
    pedestrians: Annotated[str, typer.Option(help="Pedestrians per hour and crossing.")] = "300,600",
    settings: Annotated[
        list[str] | None, typer.Option("--set", help="key=value for every controller that has it.")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1)] = 2,
) -> None:
    """Run the study and print its table."""
    from cosim.inventory import controller_parameters
    from cosim.request import parse_settings

    first, last = (int(text) for text in (*seeds.split("-"), seeds)[:2])
    extra = parse_settings(settings or [])
    work = []
    for scenario, v, p, controller, seed in itertools.product(
        scenarios.split(","),
        vehicles.split(","),
        pedestrians.split(","),
        controllers.split(","),
        range(first, last + 1),
    ):
        folder = out / f"{scenario}-v{v}-p{p}-{controller}-{seed}"
        demand = {"vehicles_per_hour": v, "pedestrians_per_hour": p}
        known = controller_parameters(controller)
        mine = {key: value for key, value in extra.items() if key in known}
        if not (folder / "runs.csv").exists():
            work.append((str(folder), scenario, controller, seed, demand | mine))
    # Seeds vary slowest: a study that is stopped early has pairs for what it has.
    work.sort(key=lambda item: item[3])
    _run_all(work, jobs)
    _report(out)


def _run_all(work: list[tuple[str, str, str, int, dict[str, str]]], jobs: int) -> None:
    import shutil

    for folder, *_ in work:
        shutil.rmtree(folder, ignore_errors=True)  # the remains of a run that was stopped
    # libsumo is one simulation per process: every run gets a fresh one.
    context = get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, max_tasks_per_child=1) as pool:
        futures = [pool.submit(run_one, *item) for item in work]
        for done, future in enumerate(as_completed(futures), 1):
            folder, reason = future.result()
            typer.echo(f"[{done}/{len(work)}] {folder} {'INVALID: ' + reason if reason else 'ok'}")


def _report(out: Path) -> None:
    from analysis.crossing_study import POOLED, read_study, summary
    from analysis.crossing_table import markdown

    folders = [path.parent for path in out.glob("*/runs.csv")]
    runs, encounters = read_study(folders)
    table = summary(runs, encounters)
    table.to_csv(out / "study.csv", index=False, float_format="%.6g")
    text = markdown(table, summary(runs, encounters, POOLED))
    (out / "study.md").write_text(text, encoding="utf-8")
    typer.echo(text)


if __name__ == "__main__":
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    typer.run(study)
