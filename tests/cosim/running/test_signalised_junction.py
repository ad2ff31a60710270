"""Turning right, left and going straight at signals: no red light is run, nobody is hit, trips end."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from controllers.interface import Decision, Perception, Plan, SignalState
from cosim.recording.recorder import Recorder
from cosim.running.execution import execute
from cosim.running.request import RunRequest
from cosim.step.loop import ToWorld

pytestmark = pytest.mark.sumo

WARMUP_S = 90.0
"""Of the scenario [s]."""
Signals = dict[str, tuple[float, SignalState]]


class RedLightWatch(Recorder):
    """Records, and notes every stop line that a front bumper passes while its light is red."""

    passed: list[tuple[str, float]]

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        super().planned(perception, decision, plan, compute_s, to_world)
        ego = perception.ego
        now = {one.name: (one.stop_line - ego.body.front, one.state) for one in perception.road.signals}
        for name, (room, state) in self._seen.get(ego.name, {}).items():
            if state is SignalState.RED and room > 0.0 >= now.get(name, (room, state))[0]:
                self.passed.append((ego.name, ego.time))
        self._seen[ego.name] = now

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._seen: dict[str, Signals] = {}


@pytest.mark.parametrize(
    ("turn", "count", "until_s", "controller"),
    [
        ("left", 1, 160.0, "vo_mpc"),
        ("left", 2, 210.0, "aeb"),
        *(
            pytest.param(turn, 4, 360.0, controller, marks=pytest.mark.slow)
            for turn in ("left", "straight", "right")
            for controller in ("vo_mpc", "aeb")
        ),
    ],
)
def test_egos_cross_it_by_its_rules_and_arrive(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, turn: str, count: int, until_s: float, controller: str
) -> None:
    monkeypatch.setattr("cosim.running.simulation.Recorder", RedLightWatch)
    monkeypatch.setattr(RedLightWatch, "passed", [], raising=False)
    out = tmp_path / "run"
    settings = {"turn": turn, "ego_count": str(count)}
    request = RunRequest(
        "signalised_junction", controller, settings=settings, duration_s=until_s - WARMUP_S, out=out
    )
    outcome = execute(request)
    assert outcome.invalid_reason == ""
    assert RedLightWatch.passed == []
    row = outcome.row
    assert row is not None
    assert row["n_vehicle_overlaps_ego_closed"] == "0"
    assert row["n_collisions"] == "0"
    last = pd.read_parquet(out / "egos.parquet").groupby("ego_id").tail(1)
    assert len(last) == count
    assert last["edge"].str.endswith("_out").all()
    assert last["time_s"].max() < until_s - 0.5
