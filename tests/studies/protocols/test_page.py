"""The page of the protocols, and what is asked for in the wrong way."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.errors import AnalysisError
from analysis.protocols.impact import Impact, Measured
from analysis.protocols.verdict import Demand, decide
from cosim.suites import judging
from cosim.suites.judging import Case
from studies.protocols.__main__ import main
from studies.protocols.page import write_page
from studies.protocols.table import Row, write


def row(case: Case, controller: str, kmh: float | None, preventable: bool = True) -> Row:
    impact = None if kmh is None else Impact(5.0, kmh / 3.6, kmh / 3.6, 0.0, 1.8, "front")
    demand = Demand(case.group.rule, case.ego_speed_kmh, case.highest_impact_kmh)
    verdict = decide(Measured(impact, False, False, 4.0, preventable), demand)
    about = (case.suite, case.name, case.group.name, controller, 1, case.ego_speed_kmh)
    return Row(*about, case.group.description, case.group.share, verdict)


def cases_of(suite: str, groups: str) -> list[Case]:
    """Return the cases of the groups whose name begins so."""
    return [case for case in judging.cases(suite) if case.group.name.startswith(groups)]


def test_the_page_has_what_was_passed_and_how_hard_the_others_were(tmp_path: Path) -> None:
    fmvss, ncap = cases_of("fmvss127", "crossing_right_25"), judging.cases("euroncap2026")
    rows = [row(case, "aeb", 12.0 if case.ego_speed_kmh == 60.0 else None, False) for case in fmvss]
    rows += [row(case, "vo_mpc", None) for case in fmvss]
    rows += [row(case, "aeb", 8.0 if case.name == "cpna_25_50kmh" else None) for case in ncap]
    write(tmp_path, rows)
    page = tmp_path / "protocols.md"
    page.write_text("# Title\n\nSaid by hand.\n\n## Tables\n\nold\n")
    write_page(tmp_path, page)
    text = page.read_text("utf-8")
    assert text.startswith("# Title\n\nSaid by hand.\n\n## Tables\n")
    assert "old" not in text
    assert "5 of 6 (60°: 12)" in text
    assert "5 of 6 (50: 8 yellow)" in text
    # 18 standard cases of CPNA: one of them is worth three quarters.
    assert f"| cpna, standard | 1 | {1.0 - 0.25 / 18.0:.3f} |" in text
    assert f"**{9.5 - 0.25 / 18.0:.2f}**" in text
    assert "after Euro NCAP 2026, transcribed" in text


def test_a_rating_of_which_a_part_was_not_driven_has_no_sum(tmp_path: Path) -> None:
    write(tmp_path, [row(case, "aeb", None) for case in cases_of("euroncap2026", "cpna_")])
    write_page(tmp_path, tmp_path / "page.md")
    text = (tmp_path / "page.md").read_text("utf-8")
    assert "| cpna, standard | 1 | 1.000 |" in text
    assert "| cpta, standard | 2 | – |" in text
    assert "**–**" in text


def test_a_page_of_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(AnalysisError, match=r"no protocol\.csv"):
        write_page(tmp_path, tmp_path / "page.md")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("fmvs127",), "did you mean 'fmvss127'"),
        (("fmvss127/nothing",), "no such case"),
        (
            ("fmvss127", "--filter", "crosing"),
            "--filter crosing: nothing in suite:fmvss127 matches; there are",
        ),
        (("fmvss127", "--controller", "aebb"), "did you mean 'aeb'"),
    ],
)
def test_what_is_not_there_is_told_in_one_line(
    words: tuple[str, ...], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
