"""The page of parameters, and the table of one controller's."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.cli import main
from cosim.running import parameters_page

PAGE = Path(__file__).resolve().parents[3] / "docs/parameters.md"


def test_the_page_of_parameters_is_current() -> None:
    assert PAGE.read_text("utf-8") == parameters_page.render()


def test_the_parameters_of_one_controller_are_listed_with_unit_bounds_and_meaning(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["list", "controllers", "vo_mpc"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "parameter default unit bounds meaning" in text
    assert "idle_interval_s 0.0 s at least 0 and at most 0.5 Time between two plans" in text
    assert main(["list", "sensing", "perfect"]) == 0
    assert "perfect has no parameters" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("controllers", "vo_mp"), "did you mean 'vo_mpc'?"),
        (("sensing", "onbord"), "did you mean 'onboard'?"),
        (("metrics", "time_to_collision"), "a name follows controllers or sensing only"),
    ],
)
def test_a_name_that_has_no_table_is_refused(
    capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], words: str
) -> None:
    assert main(["list", *arguments]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error
