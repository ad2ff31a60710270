"""What a batch says while it runs, and how long it says it will take."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.batches.conduct import Tally
from cosim.batches.estimate import in_words
from cosim.batches.outcome import Outcome, says_full
from cosim.batches.progress import shown_tally, standing
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
