"""An estimate from the command line, of a probability that can be worked out by hand."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from analysis.arrays import FloatArray
from analysis.files import read_csv
from analysis.search.probability import estimate
from benchmarks.measuring.one_pedestrian import SPACE
from cosim.cli import main
from cosim.search.estimate import first_seed

pytestmark = pytest.mark.sumo


class Noted:
    """Stands for a search space of one number: notes what is drawn, and answers each draw with a margin."""

    def __init__(self) -> None:
        self.drawn: set[float] = set()

    def __call__(self, inputs: FloatArray) -> FloatArray:
        self.drawn |= set(inputs[:, 0].tolist())
        margins: FloatArray = 2.0 - inputs[:, 0]
        return margins


@pytest.mark.parametrize("method", ["subset", "importance"])
def test_estimates_with_neighbouring_seeds_share_no_replication(method: str) -> None:
    drawn = []
    for seed in (0, 1, 2):
        noted = Noted()
        estimate(method, noted, 3, variation=0.3, most=3000, seed=first_seed(seed))
        drawn.append(noted.drawn)
    assert not drawn[0] & drawn[1]
    assert not drawn[1] & drawn[2]


def arguments(folder: Path, out: Path, *more: str) -> list[str]:
    (folder / "space.toml").write_text(SPACE)
    words = ["estimate", "jaywalk_arterial", "--controller", "constant_speed", "--method", "crude"]
    words += ["--budget", "100", "--variation", "0.9", "--space", str(folder / "space.toml")]
    return [*words, "--set", "vehicles_per_hour=0", "--out", str(out), *more]


@pytest.mark.slow
def test_the_share_of_contacts_is_the_one_of_the_geometry(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Gap and speed are even in [1, 6] s × [1, 2] m/s.

    The lane's middle is 2.5 m from the start, the ego 1.8 m wide, 4.5 m long and drives at 13.89 m/s, the
    disc has a radius of 0.25 m. There is a contact if the disc enters the ego's 2.3 m wide strip, after
    1.35 to 3.65 m, while the ego covers its line, from gap − 0.018 s for 5.0 m / 13.89 m/s = 0.36 s.
    """
    out = tmp_path / "estimate"
    assert main(arguments(tmp_path, out)) == 0
    (row,) = read_csv(out / "estimate.csv")
    contacts = total = 0
    for i in range(500):
        for j in range(100):
            gap, speed = 1.0 + 5.0 * (i + 0.5) / 500, 1.0 + (j + 0.5) / 100
            contacts += 1.35 / speed < gap + 0.342 and 3.65 / speed > gap - 0.018
            total += 1
    assert float(row["ci95_lo"]) < contacts / total < float(row["ci95_hi"])
    assert float(row["probability"]) == int(row["n_events"]) / 100
    said = capsys.readouterr().out
    assert "passages of this kind (95 %), given these distributions" in said
    # A hundred passages have no thirty near misses among the nearest ten.
    assert "Cross-check by extreme values: none; it needs 30 near misses" in said
    assert (row["n_drawn"], row["extrapolated"], row["n_peaks"]) == ("100", "", "")
    resumed = tmp_path / "resumed"
    shutil.copytree(out, resumed)
    (resumed / "estimate.csv").unlink()
    for run in sorted((resumed / "trials/runs").iterdir())[:3]:
        shutil.rmtree(run)
    assert main(arguments(tmp_path, resumed, "--jobs", "1")) == 0
    assert (resumed / "estimate.csv").read_bytes() == (out / "estimate.csv").read_bytes()


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (["--method", "crud"], "--method crud: did you mean 'crude'"),
        (["--event", "crash"], "--event crash: expected one of contact, preventable-contact, criteria"),
        (["--budget", "50"], "--budget 50: expected at least 100 runs"),
        (["--variation", "0"], "--variation: expected a number above 0 and below 1, got 0"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], told: str
) -> None:
    assert main(arguments(tmp_path, tmp_path / "new", *more)) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert not (tmp_path / "new").exists()
