"""``python -m studies.crossings.page STUDY``: write the tables of ``studies/crossings/crossings.toml``.

It writes ``study.csv`` and ``study.md`` into the folder of the study.
"""

from __future__ import annotations

import sys
from pathlib import Path

from analysis.errors import StudyError
from analysis.files import write_text
from studies.crossings.summary import POOLED, read_study, summary
from studies.crossings.table import markdown
from studies.finished import run_folders


def write_page(folder: Path) -> str:
    """Write the tables of a study into its folder and return them as Markdown.

    Raises
    ------
    StudyError
        If there are no analysed runs in the folder.
    """
    runs, encounters = read_study(run_folders(folder))
    table = summary(runs, encounters)
    table.to_csv(folder / "study.csv", index=False, float_format="%.6g")
    text = markdown(table, summary(runs, encounters, POOLED))
    write_text(folder / "study.md", text)
    return text


if __name__ == "__main__":
    try:
        print(write_page(Path(sys.argv[1])))
    except StudyError as problem:
        sys.exit(f"crossings: {problem}")
