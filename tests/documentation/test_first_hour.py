"""The clock for a newcomer's commands."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.documentation import first_hour


def test_it_times_each_command_with_its_processes(tmp_path: Path) -> None:
    busy = [sys.executable, "-c", "import time\nwhile time.process_time() < 0.2: pass"]
    one, other = first_hour.timed([busy, [sys.executable, "-c", "import time; time.sleep(0.2)"]], tmp_path)
    assert one.cpu_s >= 0.15
    assert other.cpu_s < one.cpu_s
    assert min(one.wall_s, other.wall_s) >= 0.15


def test_a_command_that_fails_ends_it(tmp_path: Path) -> None:
    with pytest.raises(subprocess.CalledProcessError):
        list(first_hour.timed([[sys.executable, "-c", "raise SystemExit(2)"]], tmp_path))


@pytest.mark.parametrize("page", first_hour.PAGES)
def test_it_times_what_the_page_shows(page: str) -> None:
    words = first_hour.of_page(page)
    names = [one[1] for one in words if one[0] == "cosim"]
    assert names.index("run") < names.index("report")
    assert not any("suite:" in " ".join(one) for one in words)


def test_a_network_of_one_s_own_takes_five_commands_to_its_first_results() -> None:
    words = [one for one in first_hour.of_page("docs/first-network.md") if one[:2] != ["cosim", "inspect"]]
    assert [one[:2] for one in words].index(["cosim", "run"]) + 1 == 5
