"""``make papers``: write the documentation's page of the papers' claims from a folder of their experiments.

``python -m studies.papers.page FOLDER DOCS`` copies the claims and the figures to ``DOCS/papers`` and writes
``DOCS/papers.md`` from them.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from analysis.files import write_text
from analysis.markdown import table
from cosim.errors import InputError
from studies.papers.catalog import found
from studies.papers.claim import Claim, Status
from studies.papers.execution import CLAIMS, FIGURES
from studies.papers.table import read_claims

_INTRODUCTION = """\
# Claims of the papers

Each method of the papers is a controller here. The papers' experiments are repeated on a road without SUMO,
with the papers' initial conditions.

    python -m studies.papers --out results/papers

runs them and writes `claims.csv` and the figures; `make papers` writes this page from them.

The status says whether a claim holds, and whether it is the paper's or ours:

- **paper's result reproduced**: a number or an event that the paper reports of its experiment comes out of
  ours, within the tolerance, and nothing was chosen for it.
- **paper's arithmetic checked**: it follows from the paper's printed numbers and equations alone.
- **fitted**: our result agrees, but for a parameter that the paper does not give, a value was chosen with
  which it does. This is no independent evidence.
- **not reproduced**: our number lies outside the tolerance, the event does not happen, or the paper leaves
  out necessary information. The last column gives the reason.
- **own check**: the paper does not say so. We checked it about our implementation, or about our reading of
  the paper; whether it holds says nothing about the paper's results.

An empty cell under "paper" means that the paper gives no number. A claim that is compared with
something else, such as another solver, says so, and the cell has that number.
"""

MISSED = (Status.NOT_REPRODUCED, Status.OWN_CHECK_FAILED)
_HEADINGS = ("experiment", "claim", "paper", "ours", "unit", "tolerance", "status", "why")


def markdown(claims: Sequence[Claim], figures: Sequence[str], titles: Mapping[str, str]) -> str:
    """Return the page as Markdown.

    Parameters
    ----------
    claims : claims in the order of the table
    figures : names of files in the folder ``papers`` beside the page, as ``<paper>-<what>.png``
    titles : titles of the papers, by number
    """
    papers = tuple(dict.fromkeys(claim.paper for claim in claims))
    parts = [_INTRODUCTION, _summary(claims, papers, titles)]
    for paper in papers:
        parts += [f"## {paper}: {titles[paper]}\n", _table([one for one in claims if one.paper == paper])]
        parts += [_figure(name) for name in sorted(figures) if name.startswith(f"{paper}-")]
    return "\n".join(parts)


def write_page(folder: Path, documentation: Path) -> None:
    """Copy claims and figures of a folder into the documentation and write the page from the copies.

    Raises
    ------
    InputError
        If the folder has no table of claims.
    """
    claims = read_claims(folder / CLAIMS)
    copies = documentation / "papers"
    shutil.rmtree(copies, ignore_errors=True)
    copies.mkdir(parents=True)
    shutil.copyfile(folder / CLAIMS, copies / CLAIMS)
    for figure in sorted((folder / FIGURES).glob("*.png")):
        shutil.copyfile(figure, copies / figure.name)
    names = [figure.name for figure in copies.glob("*.png")]
    write_text(documentation / "papers.md", markdown(claims, names, titles()))


def titles() -> dict[str, str]:
    """Return the titles of the papers, by number."""
    return {one.paper: one.title for one in found()}


def _summary(claims: Sequence[Claim], papers: Sequence[str], titles: Mapping[str, str]) -> str:
    rows = []
    for paper in papers:
        mine = [claim.status for claim in claims if claim.paper == paper]
        rows.append((paper, titles[paper], *(str(mine.count(status)) for status in Status)))
    return table(("paper", "", *(status.value for status in Status)), rows) + "\n"


def _table(claims: Sequence[Claim]) -> str:
    rows = [
        (
            claim.experiment,
            claim.claim,
            claim.paper_value,
            claim.our_value,
            claim.unit,
            claim.tolerance,
            f"**{claim.status}**" if claim.status in MISSED else claim.status.value,
            claim.why,
        )
        for claim in claims
    ]
    return table(_HEADINGS, rows) + "\n"


def _figure(name: str) -> str:
    what = Path(name).stem.partition("-")[2].replace("-", " ").replace("_", " ")
    return f"![{what}](papers/{name})\n"


if __name__ == "__main__":
    try:
        write_page(Path(sys.argv[1]), Path(sys.argv[2]))
    except InputError as problem:
        sys.exit(f"papers: {problem}")
