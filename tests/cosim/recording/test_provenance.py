"""The identity of a run."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

from cosim.recording import provenance
from cosim.recording.provenance import Inputs, commit_of

INPUTS = Inputs(
    scenario="zebra",
    scenario_parameters={"pedestrians_per_hour": 300.0},
    controller="aeb",
    controller_parameters={"friction": 0.8},
    seed=1,
    egos={"count": 1},
    step_s=0.1,
    warmup_s=10.0,
    duration_s=60.0,
    actuation="hybrid",
    files={"net.xml": "abc"},
)


@pytest.mark.parametrize(
    "change",
    [
        {"scenario": "other"},
        {"scenario_parameters": {"pedestrians_per_hour": 600.0}},
        {"controller": "sumo"},
        {"controller_parameters": {"friction": 0.7}},
        {"seed": 2},
        {"egos": {"count": 2}},
        {"step_s": 0.2},
        {"warmup_s": 20.0},
        {"duration_s": 90.0},
        {"actuation": "move"},
        {"files": {"net.xml": "abd"}},
    ],
)
def test_every_input_is_part_of_a_runs_identity(change: dict[str, Any]) -> None:
    changed = dataclasses.replace(INPUTS, **change)
    assert changed.run_id() != INPUTS.run_id()
    assert (changed.config_id() == INPUTS.config_id()) is ("seed" in change)


def test_a_runs_identity_is_the_same_every_time_and_wherever_its_files_are() -> None:
    moved = dataclasses.replace(INPUTS, files={"elsewhere/net.xml": "abc"})
    assert moved.run_id() == INPUTS.run_id() == dataclasses.replace(INPUTS).run_id()


def test_an_infinite_parameter_is_written_as_the_text_that_sets_it() -> None:
    infinite = dataclasses.replace(INPUTS, controller_parameters={"truncation_s": float("inf")})
    assert provenance.describe(infinite, "1")["parameters"]["controller"] == {"truncation_s": "inf"}


def test_versions_are_part_of_a_runs_identity(monkeypatch: pytest.MonkeyPatch) -> None:
    before = INPUTS.run_id()
    monkeypatch.setattr(provenance, "versions", lambda: {"libsumo": "1.0"})
    assert INPUTS.run_id() != before


def test_the_description_can_be_written_and_begins_as_not_valid() -> None:
    description = provenance.describe(INPUTS, "1")
    assert json.loads(json.dumps(description))["valid"] is False
    wanted = {
        *("run_id", "scenario_id", "controller", "seed", "config_id", "tool_version", "git_sha"),
        *("sumo_version", "versions", "start_utc", "wall_s", "step_s", "warmup_s", "duration_s", "valid"),
        *("invalid_reason", "actuation", "sensing", "parameters", "inputs", "n_teleports"),
        "recording_schema_version",
    }
    assert wanted <= set(description)
    assert description["parameters"]["controller"] == {"friction": 0.8}


def test_the_commit_is_asked_for_without_touching_the_checkout(tmp_path: Path) -> None:
    def git(*words: str) -> None:
        name = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
        subprocess.run(["git", *name, "-C", tmp_path, *words], check=True, capture_output=True)

    git("init")
    assert commit_of(tmp_path) is None
    file = tmp_path / "file"
    file.write_text("one")
    git("add", "file")
    git("commit", "--message", "one")
    index = (tmp_path / ".git" / "index").read_bytes()
    os.utime(file, (0, 0))  # git looks again, and would note in its index that nothing has changed
    clean = commit_of(tmp_path)
    assert clean is not None
    assert len(clean) == 40
    assert (tmp_path / ".git" / "index").read_bytes() == index
    file.write_text("two")
    assert commit_of(tmp_path) == f"{clean}-dirty"
    assert commit_of(tmp_path / "nothing") is None
