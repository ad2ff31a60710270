"""Files beside the user's own that are named like modules of the standard library are not executed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.cosim.batches.studies import write_study
from tests.cosim.cli.commands import source_environment

pytestmark = pytest.mark.sumo


@pytest.mark.long
def test_modules_in_the_current_folder_are_not_executed_by_a_batch(tmp_path: Path) -> None:
    study = write_study(tmp_path, seeds="1")
    for name in ("multiprocessing", "signal", "queue"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'a').write({name!r})\n")
    cosim = Path(sys.executable).parent / "cosim"
    done = subprocess.run(
        [cosim, "batch", study.name, "--out", "out", "--jobs", "1"],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
        env=source_environment(),
    )
    assert not (tmp_path / "executed").exists()
    assert done.returncode == 0, done.stderr
    assert "1 of 1 runs finished" in done.stdout
