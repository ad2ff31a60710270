"""``python -m studies.papers``: what it writes, what it refuses, and that the documentation shows it."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import pytest

from cosim.errors import InputError
from studies.papers.__main__ import main
from studies.papers.catalog import EXTRA, found
from studies.papers.claim import compared, observed
from studies.papers.page import markdown, titles
from studies.papers.table import COLUMNS, read_claims, write_claims
from tests.cosim.cli.commands import source_environment
from tests.studies.papers.holds import HOLDS

DOCUMENTATION = Path(__file__).resolve().parents[3] / "docs"
PAPER = "003"
LONGEST_S = 300.0

CLAIMS = [
    compared("004", "E1", "It stops, in time.", theirs=29.0, ours=29.2, tolerance=0.5, unit="s"),
    compared("004", "E1", 'It "stops".', theirs=29.0, ours=31.0, tolerance=0.5, unit="s", why="a | b"),
    observed("003", "all", "No kerb is crossed.", holds=True, theirs="−", ours="", fitted="width = 3.5 m"),
]


def _cpu_time_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Run a command that must be refused, and return its one line."""
    assert main(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("papers: ")
    return str(line)


def _contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_claims_are_read_as_they_were_written(tmp_path: Path) -> None:
    path = tmp_path / "claims.csv"
    write_claims(path, CLAIMS)
    assert path.read_text(encoding="utf-8").splitlines()[0] == ",".join(COLUMNS)
    assert read_claims(path) == CLAIMS
    assert [file.name for file in tmp_path.iterdir()] == ["claims.csv"]


def test_a_file_that_is_no_table_of_claims_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "claims.csv"
    for text in (
        "",
        "a,b\n1,2\n",
        ",".join(COLUMNS) + "\n004,E1\n",
        ",".join(COLUMNS) + "\n" + "x," * 8 + "x\n",
    ):
        path.write_text(text)
        with pytest.raises(InputError, match="claims"):
            read_claims(path)
    with pytest.raises(InputError, match="nowhere"):
        read_claims(tmp_path / "nowhere.csv")


def test_the_page_has_every_claim_in_a_table_and_every_figure_under_its_paper() -> None:
    names = {"004": "Speeds", "003": "Fields"}
    page = markdown(CLAIMS, ["003-field.png", "004-static-speed.png"], names)
    for claim in CLAIMS:
        assert claim.claim in page
    assert "a \\| b" in page
    assert page.index("## 004: Speeds") < page.index("004-static-speed.png") < page.index("## 003: Fields")
    assert page.index("## 003: Fields") < page.index("![field](papers/003-field.png)")
    rows = [line for line in page.splitlines() if line.startswith("| ")]
    assert len({line.replace("\\|", "").count("|") for line in rows if "E1" in line or "all" in line}) == 1


def test_an_unknown_paper_is_answered_by_those_that_exist(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    line = refused(capsys, "999", "--out", str(tmp_path / "out"))
    assert "'999'" in line
    assert PAPER in line
    assert not (tmp_path / "out").exists()


def test_a_folder_with_files_in_it_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert "files in it" in refused(capsys, PAPER, "--out", str(tmp_path))
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


@pytest.mark.parametrize("package", EXTRA)
def test_a_missing_package_is_named_with_how_to_get_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)  # what an import of something not installed meets
    line = refused(capsys, "--out", str(tmp_path / "out"))
    assert package in line
    assert "pip install -e '.[papers]'" in line


@pytest.mark.slow
def test_all_papers_twice_give_the_same_files_within_five_minutes(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "studies.papers", "--out"]
    for name in ("first", "second"):
        begun = _cpu_time_of_children()
        subprocess.run(
            [*command, str(tmp_path / name)], check=True, capture_output=True, env=source_environment()
        )
        # Of both processes together, so that it says something about a machine that is busy, too.
        assert _cpu_time_of_children() - begun < LONGEST_S
    first, second = _contents(tmp_path / "first"), _contents(tmp_path / "second")
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == []
    claims = read_claims(tmp_path / "first" / "claims.csv")
    assert {claim.paper for claim in claims} == {one.paper for one in found()}
    assert all(claim.why for claim in claims if claim.status not in HOLDS)


def test_the_documentation_shows_the_claims_that_lie_beside_it() -> None:
    claims = read_claims(DOCUMENTATION / "papers" / "claims.csv")
    figures = [path.name for path in (DOCUMENTATION / "papers").glob("*.png")]
    page = (DOCUMENTATION / "papers.md").read_text(encoding="utf-8")
    assert page == markdown(claims, figures, titles())
    assert {claim.paper for claim in claims} == {one.paper for one in found()}
    assert figures
