"""``cosim check``: criteria for scenarios, studies and suites."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cosim.cli import names, terminal
from cosim.cli.options import Debug, Jobs, Settings

if TYPE_CHECKING:
    from cosim.checks.finding import Finding

Targets = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="TARGET…",
        help="Scenario, SUMO configuration, study file, or suite:NAME.",
        autocompletion=names.targets,
    ),
]
Made = Annotated[
    Path | None,
    typer.Option(
        "--results",
        metavar="DIR",
        help="Judge the runs that are in this folder instead of making runs.",
    ),
]
Folder = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="DIR",
        help="Output folder; resumes an earlier check.",
        show_default="runs/check-…",
    ),
]
Junit = Annotated[Path | None, typer.Option("--junit", metavar="FILE", help="Write JUnit XML to this file.")]
Controllers = Annotated[
    list[str] | None,
    typer.Option(
        "--controller",
        metavar="NAME",
        help="Controller that drives the egos; repeatable.",
        autocompletion=names.drivers,
        show_default="as the study, otherwise vo_mpc",
    ),
]
Seeds = Annotated[
    str | None,
    typer.Option(metavar="1-5", help="Seeds.", show_default="as the study, otherwise 1"),
]
Criteria = Annotated[
    Path | None,
    typer.Option(
        "--criteria", metavar="FILE.toml", help="Use these criteria instead of those of the targets."
    ),
]
Part = Annotated[
    str | None,
    typer.Option("--filter", metavar="TEXT", help="Only scenarios or cases whose name contains this text."),
]
Earlier = Annotated[
    Path | None,
    typer.Option(
        "--baseline", metavar="DIR", help="Fail if a key measure is worse than in this earlier check."
    ),
]
Level = Annotated[
    float,
    typer.Option("--level", metavar="P", help="Significance level of the baseline comparison."),
]
RunTimeout = Annotated[
    float | None,
    typer.Option("--run-timeout-s", metavar="S", help="Wall-clock limit of a run [s].", show_default="3600"),
]
DropRecordings = Annotated[bool, typer.Option("--drop-recordings", help="Keep only the numbers of each run.")]


def check(
    targets: Targets = None,
    results: Made = None,
    out: Folder = None,
    junit: Junit = None,
    controller: Controllers = None,
    seeds: Seeds = None,
    settings: Settings = None,
    criteria: Criteria = None,
    part: Part = None,
    baseline: Earlier = None,
    level: Level = 0.05,
    jobs: Jobs = None,
    run_timeout_s: RunTimeout = None,
    drop_recordings: DropRecordings = False,
    debug: Debug = False,
) -> int:
    """Run scenarios, studies or suites and check their results against criteria.

    \b
    Examples:
      cosim check midblock_zebra --junit results.xml
      cosim check midblock_zebra midblock_unmarked --controller aeb --seeds 1-5 --out checks/aeb
      cosim check study.toml --out checks/today --baseline checks/release --level 0.01
      cosim check town.sumocfg --criteria criteria.toml --set ego_share=0.1 --set duration_s=600
      cosim check --results results/study --criteria criteria.toml --junit results.xml

    \b
    A criterion, in scenario.toml, in a study file, or in a file for --criteria:
      [[criteria]]
      scope = "run"
      metric = "n_collisions"
      operator = "=="
      threshold = 0

    \b
    Exit codes: 0 all criteria are met, 1 one is not, 2 bad input (nothing is run), 3 a run is invalid:
    an error, a time-out, a teleported ego.
    """
    if results is not None:
        options = (targets, controller, seeds, settings, part, baseline, jobs, run_timeout_s)
        return _check_results(results, out, junit, criteria, any(options) or drop_recordings)
    if not targets:
        raise typer.BadParameter("expected a TARGET, or --results DIR")
    from cosim.batches.progress import shown_checks, shown_tally
    from cosim.checks.check import CheckRequest, prepared
    from cosim.checks.target import Wishes
    from cosim.running.request import parse_settings

    wishes = Wishes(
        controllers=tuple(dict.fromkeys(controller or [])),
        seeds=seeds,
        settings=parse_settings(settings or []),
        criteria=criteria,
        part=part,
        run_timeout_s=run_timeout_s,
    )
    request = CheckRequest(
        targets=tuple(targets),
        out=out,
        junit=junit,
        wishes=wishes,
        jobs=jobs,
        drop_recordings=drop_recordings,
        baseline=baseline,
        level=level,
    )
    with prepared(request, shown_checks()) as one:
        result = one.run(shown_tally)
    _show(result.findings)
    if result.stopped:
        typer.echo(
            f"cosim: {result.stopped}; to resume, repeat the command with --out {result.folder}", err=True
        )
    _show_verdict(result.findings, result.folder, result.folder)
    return result.exit_code


def _check_results(
    results: Path, out: Path | None, junit: Path | None, criteria: Path | None, others: bool
) -> int:
    """Judge the runs that are there."""
    from cosim.checks.check import check_folder
    from cosim.checks.existing import Results, judge_results
    from cosim.checks.files import check_junit, write_findings
    from cosim.checks.finding import exit_code
    from cosim.errors import InputError

    if others:
        raise InputError(
            "--results judges the runs that are there: only --criteria, --junit and --out go with it"
        )
    folder = results if out is None else out
    if folder.resolve() != results.resolve():
        check_folder(folder)
    check_junit(junit)
    findings = judge_results(Results(results, criteria))
    write_findings(folder, findings, junit)
    _show(findings)
    _show_verdict(findings, folder, results)
    return exit_code(findings)


def _show(findings: Sequence[Finding]) -> None:
    from cosim.checks import summary

    terminal.console().print(summary.table(findings))
    for line in summary.failures(findings):
        typer.echo(f"cosim: {line}", err=True)


def _show_verdict(findings: Sequence[Finding], folder: Path, runs: Path) -> None:
    from cosim.checks import summary

    told = f"\n{summary.verdict(findings)}\nfiles: {folder}; report with replays: cosim report {runs}"
    terminal.console().print(told, soft_wrap=True)
