"""The page of the study counts what the searches' tables say."""

from __future__ import annotations

import json
from pathlib import Path

from studies.falsify.page import row, write_page


def finished(folder: Path) -> Path:
    folder.mkdir(parents=True)
    (folder / "trials.csv").write_text(
        "trial,seed,status,margin\n1,1,pass,0.5\n2,1,unpreventable,0.01\n3,1,fail,-0.75\n4,1,invalid,\n"
    )
    (folder / "kinds.csv").write_text("kind,name,n_failures,margin\n1,contact hard,1,-0.75\n")
    return folder


def test_a_line_counts_failures_and_names_the_first(tmp_path: Path) -> None:
    assert row(finished(tmp_path / "one"), "aeb", "road") == {
        "scenario": "road",
        "controller": "aeb",
        "runs": 4,
        "preventable failures": 1,
        "kinds": 1,
        "first in run": 3,
        "unpreventable": 1,
        "invalid": 1,
        "smallest margin": "-0.75",
    }


def test_what_is_not_made_is_said_and_the_kinds_of_our_controller_are_listed(tmp_path: Path) -> None:
    finished(tmp_path / "vo_mpc" / "road")
    write_page(tmp_path, ("vo_mpc", "aeb"), ("road",), tmp_path / "page.md")
    text = (tmp_path / "page.md").read_text()
    assert "1 of 2 searches are not made." in text
    assert "contact hard" in text.partition("## Kinds of failures")[2]


def test_the_page_names_the_code_of_its_runs(tmp_path: Path) -> None:
    runs = finished(tmp_path / "vo_mpc" / "road") / "trials" / "runs"
    for number, commit in enumerate(("b" * 40, "a" * 40, "b" * 40)):
        (runs / str(number)).mkdir(parents=True)
        (runs / str(number) / "run.json").write_text(json.dumps({"git_sha": commit}))
        (runs / str(number) / "runs.csv").touch()
    write_page(tmp_path, ("vo_mpc",), ("road",), tmp_path / "page.md")
    assert "used for nothing else. Code of aaaaaaaa, bbbbbbbb.\n" in (tmp_path / "page.md").read_text()
