"""The page of the study of validation, from small runs of the same kind."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.validation.page import RESULTS, markdown
from tests.analysis.trajectories import streets
from tests.cosim.cli.commands import ended
from tests.cosim.tracks import networks
from tests.documentation.command_blocks import ROOT


@pytest.mark.sumo
@pytest.mark.slow
def test_the_page_says_of_every_quantity_what_follows(tmp_path: Path) -> None:
    networks.street(tmp_path)
    street, tracks = networks.configure(tmp_path), streets.write(tmp_path / "t.csv", streets.rush())
    one = (street, "--tracks", tracks, "--jobs", "1")
    ended("validate", *one, "--seeds", "1", "--out", tmp_path / "study" / "all")
    ended("calibrate", *one, "--seeds", "1", "--split", "100", "--out", tmp_path / "study" / "calibration")
    for name in ("planted.md", "pairs.txt", "cost.md", "misses.md", "in-place.md"):
        (tmp_path / "study" / name).write_text(f"content of {name}\n")
    text = markdown(tmp_path / "study")
    assert "what: 10 car, 10 pedestrian. Left out" in text
    assert "| walking_speed | m/s | 1.45 |" in text
    assert "mean speed of a moving bicycle: 0 real and 0 simulated road users have a value" in text
    assert "| walking_speed | m/s | 1.20 |" in text
    assert "content of pairs.txt" in text
    assert text.count("| yielding |") == 2


def test_the_published_page_has_results() -> None:
    page = (ROOT / "docs/validation.md").read_text("utf-8")
    assert RESULTS in page
    assert "pairs within 45 m of each other" in page
