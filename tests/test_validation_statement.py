"""What validation says stands where users read it."""

from __future__ import annotations

from pathlib import Path

from analysis.validation.statement import SENTENCE


def test_the_readme_says_what_validation_says() -> None:
    assert SENTENCE in (Path(__file__).resolve().parents[1] / "README.md").read_text("utf-8")
