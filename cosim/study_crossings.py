"""``make study-crossings``: controllers at mid-block crossings, on the same seeds, as a batch.

A run that is done already is not run again, so the study can be stopped and resumed. Beside the tables of
every batch it writes ``study.csv`` and ``study.md`` into its folder.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

SCENARIOS = "midblock_zebra,midblock_unmarked"
CONTROLLERS = "vo_mpc,sumo,aeb"


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
        list[str] | None, typer.Option("--set", help="key=value for everything that has it.")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1)] = 2,
) -> None:
    """Run the study and print its table."""
    from cosim.batch.batch import BatchRequest, prepared
    from cosim.batch.progress import shown_tally
    from cosim.commands.interruption import termination_interrupts
    from cosim.errors import InputError
    from cosim.request import parse_settings

    # JSON's texts and lists are TOML's too.
    demand = {"vehicles_per_hour": vehicles, "pedestrians_per_hour": pedestrians}
    lines = [
        f"scenarios = {json.dumps(scenarios.split(','))}",
        f"controllers = {json.dumps(controllers.split(','))}",
        f"seeds = {json.dumps(seeds)}",
        "[set]",
        *(f"{key} = {json.dumps(text)}" for key, text in parse_settings(settings or []).items()),
        "[vary]",
        *(f"{key} = {json.dumps(texts.split(','))}" for key, texts in demand.items()),
    ]
    with TemporaryDirectory() as folder:
        file = Path(folder) / "study.toml"
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        try:
            with termination_interrupts(), prepared(BatchRequest(file, out, jobs)) as batch:
                result = batch.run(shown_tally())
        except InputError as error:
            typer.echo(str(error), err=True)
            raise typer.Exit(2) from error
    tally = result.tally
    typer.echo(f"{tally.done} of {tally.total} runs finished, {tally.failed} failed {result.stopped}")
    for name, reason in result.not_valid.items():
        typer.echo(f"INVALID: {name}: {reason}")
    if tally.done:
        _report(out)
    if not result.good:
        raise typer.Exit(3)


def _report(out: Path) -> None:
    from analysis.crossing_study import POOLED, read_study, summary
    from analysis.crossing_table import markdown

    folders = [path.parent for path in (out / "runs").glob("*/runs.csv")]
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
