"""``cosim compare``: is one controller safer than another, and slower?"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug

if TYPE_CHECKING:
    from analysis.results.measures import Measure
    from analysis.study.design import Condition, Study


def compare(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Folder of a study, or any folder that contains run folders."),
    ],
    alt: Annotated[
        str, typer.Option(metavar="NAME", help="Controller to compare, optionally with parameters.")
    ],
    base: Annotated[str, typer.Option(metavar="NAME", help="Controller to compare it with.")] = "sumo",
    metrics: Annotated[
        list[str] | None,
        typer.Option(
            "--metric",
            metavar="NAME",
            help="Measure to compare; repeatable.",
            show_default="the key measures",
        ),
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(metavar="NAME", help="Only this scenario.", show_default="all")
    ] = None,
    each: Annotated[
        bool, typer.Option("--each", help="One table per setting of a scenario instead of one for all.")
    ] = False,
    write: Annotated[
        bool, typer.Option("--write", help="Also write the rows to DIR/comparison-BASE-ALT.csv.")
    ] = False,
    debug: Debug = False,
) -> int:
    """Compare two controllers on the same seeds: is one safer, and is it slower?

    \b
    Examples:
      cosim compare results/study --base sumo --alt vo_mpc
      cosim compare runs --base sumo --alt aeb --metric ego_delay_mean_s --metric n_lane_changes
      cosim compare results/study --alt "vo_mpc horizon=20" --each --write

    \b
    Exit codes: 0 success, 2 no such folder, controller, measure or scenario, or no seed in common.
    """
    from analysis.errors import AnalysisError
    from analysis.study.comparison_rows import compare_labels, correct, pair_runs, shared_conditions
    from analysis.study.design import read_study
    from analysis.study.runs import find_run_folders
    from analysis.study.writing import write_comparison
    from cosim.errors import InputError
    from cosim.presentation.wording import notes, sentence, table

    try:
        study = read_study(find_run_folders(folder))
    except AnalysisError as error:
        raise InputError(str(error)) from error
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder")
    if not study.runs:
        raise InputError(
            f"{folder}: contains no runs; expected the folder of a study or a folder of run folders"
        )
    one, other = _label(study, folder, "--base", base), _label(study, folder, "--alt", alt)
    if one == other:
        raise InputError(f"--base {base} and --alt {alt} are the same; available: {_all(study)}")
    chosen = _measures(metrics or [])
    by_name = {measure.name: measure for measure in chosen}
    console = terminal.console()
    left_out: list[Condition] = []
    written: list[dict[str, Any]] = []
    for scope in _scopes(study, scenario, each):
        rows = compare_labels(study, scope, one, other, chosen)
        pairs = pair_runs(study, shared_conditions(study, scope, one, other), one, other)
        if not pairs.base:
            left_out += scope
            continue
        correct(rows, "chosen" if metrics else "key")
        runs = [run for side in (*pairs.base, *pairs.alt) for run in side]
        if written:
            console.print()
        console.print(sentence(rows, by_name) + "\n", soft_wrap=True)
        console.print(table(rows, by_name))
        console.print("\n" + "\n".join(notes(rows, pairs, runs)), soft_wrap=True)
        written += rows
    if not written:
        raise InputError(_nothing_in_common(study, folder, one, other))
    if left_out:
        names = ", ".join(f"{where.scenario_id} {where.text}".strip() for where in left_out)
        console.print(f"Left out, because no seed in common has valid runs: {names}.", soft_wrap=True)
    if write:
        path = folder / f"comparison-{_file_name(one)}-{_file_name(other)}.csv"
        try:
            write_comparison(path, written)
        except OSError as error:
            raise InputError(f"{path} cannot be written: {error.strerror}") from error
        console.print(f"file: {path}", soft_wrap=True)
    return 0


def _label(study: Study, folder: Path, flag: str, name: str) -> str:
    from cosim.errors import InputError

    labels = study.matching(name)
    if not labels:
        raise InputError(f"{flag} {name}: no run of it in {folder}; available: {_all(study)}")
    if len(labels) > 1:
        raise InputError(f"{flag} {name} is ambiguous: {', '.join(map(repr, labels))}")
    return labels[0]


def _all(study: Study) -> str:
    return ", ".join(repr(label) if " " in label else label for label in study.all_labels())


def _measures(names: list[str]) -> list[Measure]:
    import difflib

    from analysis.results.measures import run_measures
    from cosim.errors import InputError

    known = {measure.name: measure for measure in run_measures()}
    if not names:
        return [measure for measure in known.values() if measure.key]
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f"did you mean {near[0]!r}? " if near else ""
            keys = ", ".join(measure.name for measure in known.values() if measure.key)
            raise InputError(
                f"--metric {name}: no such measure; {hint}available: the key measures ({keys}), the other "
                "shares and rates of docs/statistics.md, and all numbers of runs.csv except wall-clock times"
            )
    return [known[name] for name in dict.fromkeys(names)]


def _scopes(study: Study, scenario: str | None, each: bool) -> list[list[Condition]]:
    from cosim.errors import InputError

    names = sorted({one.scenario_id for one in study.conditions})
    if scenario is not None and scenario not in names:
        raise InputError(f"--scenario {scenario}: no run of it; available: {', '.join(names)}")
    chosen = [one for one in study.conditions if scenario in (None, one.scenario_id)]
    if each:
        return [[one] for one in chosen]
    return [found for name in names if (found := [one for one in chosen if one.scenario_id == name])]


def _nothing_in_common(study: Study, folder: Path, base: str, alt: str) -> str:
    from analysis.study.comparison_rows import pair_runs

    if any(pair_runs(study, [one], base, alt).base for one in study.conditions):
        return (
            f"{folder}: no seed was run under all settings of a scenario; --each compares setting by setting"
        )
    said = []
    for label in (base, alt):
        runs = [run for run in study.runs if study.label(run) == label]
        where = ", ".join(sorted({run.scenario_id for run in runs}))
        said.append(f"{label} has {_seeds(sorted({run.seed for run in runs if run.valid}))} on {where}")
    return f"{folder}: no seed in common under the same settings with valid runs: {'; '.join(said)}"


def _seeds(seeds: list[int]) -> str:
    if not seeds:
        return "no valid run"
    shown = ", ".join(map(str, seeds[:10])) + (", …" if len(seeds) > 10 else "")
    return f"seed{'s' if len(seeds) > 1 else ''} {shown}"


def _file_name(label: str) -> str:
    import re

    return re.sub(r"[^A-Za-z0-9_.=]+", "_", label)
