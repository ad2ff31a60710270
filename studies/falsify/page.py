"""The page of the study: failures by controller and scenario, and the kinds of failures of ``vo_mpc``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from analysis.files import read_csv, read_json, write_text
from analysis.markdown import table_of
from analysis.study.runs import find_run_folders

FINISHED = "kinds.csv"
"""File that exists when a search is finished."""
OURS = "vo_mpc"
HEAD = (
    "# Study: what breaks the controllers\n\n"
    "<!-- no-run: takes minutes -->\n\n    make study-falsify\n\n"
    "writes this page. Each controller was searched on each scenario with the same budget by "
    "[`cosim falsify`](falsify.md): a few dozen trials, which is little; more would find more. Only "
    "failures that a careful driver would have prevented are counted; runs with one that nobody could have "
    "prevented stand beside them. The seed was used for nothing else."
)


def write_page(folder: Path, controllers: Sequence[str], scenarios: Sequence[str], page: Path) -> None:
    """Write the page from the finished searches.

    Parameters
    ----------
    folder
        Folder of the searches.
    controllers, scenarios
        Names in the order of the table.
    page
        Markdown file.
    """
    done = [
        (controller, scenario)
        for scenario in scenarios
        for controller in controllers
        if (folder / controller / scenario / FINISHED).is_file()
    ]
    text = HEAD + _code(folder) + "\n\n"
    text += table_of([row(folder / one / scenario, one, scenario) for one, scenario in done]) + "\n"
    missing = len(controllers) * len(scenarios) - len(done)
    if missing:
        text += f"\n{missing} of {missing + len(done)} searches are not made.\n"
    kinds = [
        kind for one, scenario in done if one == OURS for kind in _kinds(folder / one / scenario, scenario)
    ]
    text += f"\n## Kinds of failures of `{OURS}`\n\n"
    text += table_of(kinds) + "\n" if kinds else "None was found.\n"
    write_text(page, text)


def row(search: Path, controller: str, scenario: str) -> dict[str, Any]:
    """Return the table row of a search.

    Parameters
    ----------
    search
        Folder of the search.
    controller, scenario
    """
    trials = read_csv(search / "trials.csv")
    statuses = [one["status"] for one in trials]
    margins = [float(one["margin"]) for one in trials if one["margin"]]
    return {
        "scenario": scenario,
        "controller": controller,
        "runs": len(trials),
        "preventable failures": statuses.count("fail"),
        "kinds": len(read_csv(search / FINISHED)),
        "first in run": statuses.index("fail") + 1 if "fail" in statuses else "–",
        "unpreventable": statuses.count("unpreventable"),
        "invalid": statuses.count("invalid"),
        "smallest margin": f"{min(margins):.2f}" if margins else "–",
    }


def _code(folder: Path) -> str:
    """Return a sentence that names the commits of the runs' code; empty if they do not know it."""
    commits = {read_json(run / "run.json").get("git_sha") for run in find_run_folders(folder)}
    known = sorted(commit[:8] for commit in commits if commit)
    return f" Code of {', '.join(known)}." if known else ""


def _kinds(search: Path, scenario: str) -> list[dict[str, Any]]:
    return [
        {
            "scenario": scenario,
            "kind": one["name"],
            "runs": one["n_failures"],
            "smallest margin": one["margin"],
        }
        for one in read_csv(search / FINISHED)
    ]
