"""What a batch says while it runs, and how long it says it will take."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cosim.batches.conduct import Tally
from cosim.batches.estimate import ROUGH_SPEED, ROUGH_START_S, estimate, in_words
from cosim.batches.ledger import Ledger
from cosim.batches.outcome import Outcome, says_full
from cosim.batches.preflight import Checked
from cosim.batches.progress import shown_tally, standing
from cosim.recording.provenance import Inputs
from tests.cosim.batches.studies import some_job


def test_runs_of_an_earlier_batch_do_not_count_for_the_rate() -> None:
    tally = Tally(total=100, done=60, made=10, running=2)
    assert standing(tally, 60.0) == "60 of 100 done, 0 failed, 2 running, 10.0 runs/min, 4 min left"


def test_nothing_is_said_of_the_rate_before_the_first_run_is_over() -> None:
    assert standing(Tally(total=9, done=3, running=2), 60.0) == "3 of 9 done, 0 failed, 2 running"


def test_a_log_gets_whole_lines_and_each_failure_once(capsys: pytest.CaptureFixture[str]) -> None:
    tally = Tally(total=4, done=1, made=1)
    tally.failures.append(Outcome(some_job(), Path("gone"), "it broke"))
    with shown_tally(log_every_s=0.0) as show:
        show(tally)
        show(tally)
    lines = capsys.readouterr().err.splitlines()
    assert [line for line in lines if "it broke" in line] == [lines[0]]
    assert f"failed: {some_job().name}: it broke" in lines[0]
    assert "\r" not in "".join(lines)
    assert "\x1b" not in "".join(lines)
    assert "1 of 4 done" in lines[-1]


INPUTS = Inputs("zebra", {}, "sumo", {}, 1, {}, 0.1, 2.0, 6.0, "hybrid", {})
"""Of a run of 6 s."""


def test_the_time_left_is_told_by_what_finished_runs_of_the_same_kind_took(tmp_path: Path) -> None:
    """With one controller 3 and 5 s for each run, with the other 12 s: what is missing takes 4 + 12 + 12 s."""
    jobs = [some_job(seed, controller) for seed in (1, 2, 3) for controller in ("sumo", "aeb")]
    checked = Checked({job.configuration: (INPUTS, "") for job in jobs})
    ledger = Ledger(tmp_path / "out")
    rough = estimate(jobs, jobs, ledger, checked, processes=3)
    assert rough.wall_s == pytest.approx(2.0 * (ROUGH_START_S + 6.0 / ROUGH_SPEED))
    assert "a rough figure" in rough.basis
    for job, wall_s in zip(jobs[:3], (3.0, 12.0, 5.0), strict=True):
        folder = ledger.run_folder(job.name)
        folder.mkdir(parents=True)
        (folder / "run.json").write_text(json.dumps({"wall_total_s": wall_s}))
        (folder / "job.json").write_text('{"source": "x"}')
    missing = ledger.missing(jobs)
    for processes, wall_s in ((1, 28.0), (2, 14.0), (8, 28.0 / 3.0)):
        found = estimate(jobs, missing, ledger, checked, processes)
        assert found.wall_s == pytest.approx(wall_s)
        assert found.basis == "from the 3 finished runs of this study"
    ledger.damaged[jobs[2].name] = "lost"
    assert estimate(jobs, missing, ledger, checked, 1).wall_s == pytest.approx(27.0)
    assert estimate(jobs[:3], [], ledger, checked, 1).wall_s == 0.0


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.4, "0 s"),
        (89, "89 s"),
        (90, "2 min"),
        (3570, "1 h 0 min"),
        (7260, "2 h 1 min"),
        (2.6e5, "3.0 days"),
    ],
)
def test_a_time_is_said_as_people_say_it(seconds: float, words: str) -> None:
    assert in_words(seconds) == words


def test_a_full_disk_is_told_from_other_errors() -> None:
    assert says_full("the recording could not be written: No space left on device")
    assert says_full("OSError: Disk quota exceeded")
    assert not says_full("the controller failed: division by zero")
