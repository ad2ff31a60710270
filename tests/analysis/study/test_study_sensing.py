"""Studies that vary what egos can sense."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from analysis.study.design import read_study
from tests.analysis.study.study_folders import write_study_run


def _write(folder: Path, sensing: str, **parameters: Any) -> Path:
    write_study_run(folder, "aeb", 1, run_id=folder.name)
    description = json.loads((folder / "run.json").read_text())
    description["sensing"] = sensing
    description["parameters"]["sensing"] = parameters
    description["config_id"] = f"aeb-{folder.name}"
    (folder / "run.json").write_text(json.dumps(description))
    return folder


def test_a_condition_is_named_by_the_model_and_by_what_of_it_varies(tmp_path: Path) -> None:
    folders = [
        _write(tmp_path / "a", "perfect"),
        _write(tmp_path / "b", "onboard", range_m=60.0, hold_s=1.0),
        _write(tmp_path / "c", "roadside", latency_ms=0.0, loss_probability=0.0),
        _write(tmp_path / "d", "roadside", latency_ms=500.0, loss_probability=0.0),
    ]
    assert [one.text for one in read_study(folders).conditions] == [
        "sensing=onboard",
        "sensing=perfect",
        "sensing=roadside sensing.latency_ms=0.0",
        "sensing=roadside sensing.latency_ms=500.0",
    ]


def test_a_model_is_one_condition_with_each_of_its_parameters(tmp_path: Path) -> None:
    folders = [_write(tmp_path / f"{reach:g}", "onboard", range_m=reach) for reach in (40.0, 60.0)]
    found = read_study(folders).conditions
    assert [one.text for one in found] == ["sensing.range_m=40.0", "sensing.range_m=60.0"]
    assert len({one.condition_id for one in found}) == 2
