"""Turning right, left and going straight at signals: no red light is run, nobody is hit, trips end."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import pytest

from controllers.driving.standing import STANDING
from controllers.interface import Decision, Perception, Plan, SignalState
from cosim.recording.recorder import Recorder
from cosim.running.execution import execute
from cosim.running.request import RunRequest
from cosim.step.loop import ToWorld

pytestmark = [pytest.mark.sumo, pytest.mark.long]

WARMUP_S = 90.0
"""Of the scenario [s]."""
NEAR = 10.0
"""A line so near that is no longer told has been passed [m]."""
TURNS = ("left", "straight", "right")
LEFT = ("south_approach", "west_exit")
"""The last 90 m before the junction, and the first ones behind it."""
Signals = dict[str, tuple[float, SignalState]]
AEB_TOO = pytest.param("aeb", marks=pytest.mark.slow)


class RedLightWatch(Recorder):
    """Records, and notes who passes a stop line while its light is red, and who stands before one."""

    passed: list[tuple[str, float]]
    waited: set[str]

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        super().planned(perception, decision, plan, compute_s, to_world)
        ego = perception.ego
        now = {one.name: (one.stop_line - ego.body.front, one.state) for one in perception.road.signals}
        for name, (room, state) in self._seen.get(ego.name, {}).items():
            gone = now[name][0] <= 0.0 if name in now else room < NEAR  # a line that is passed is not told
            if state is SignalState.RED and room > 0.0 and gone:
                self.passed.append((ego.name, ego.time))
            if state is SignalState.RED and 0.0 < room < NEAR and ego.speed < STANDING:
                self.waited.add(ego.name)
        self._seen[ego.name] = now

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._seen: dict[str, Signals] = {}


@pytest.mark.parametrize("controller", ["vo_mpc", AEB_TOO])
def test_an_ego_turns_left_through_the_oncoming_traffic_and_arrives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, controller: str
) -> None:
    """It comes in 90 m before the junction, while its light is green."""
    row, last = _driven(tmp_path, monkeypatch, controller, {}, 150.0, 110.0, LEFT)
    assert row["n_vehicle_overlaps_ego_closed"] == "0"
    assert row["n_collisions"] == "0"
    assert last["edge"].tolist() == [LEFT[-1]]
    assert 110.0 + 10.0 < last["time_s"].max() < 150.0 - 0.5


@pytest.mark.slow
@pytest.mark.parametrize("controller", ["vo_mpc", "aeb"])
@pytest.mark.parametrize(
    ("turn", "count", "until_s"), [("left", 2, 210.0), *((turn, 4, 360.0) for turn in TURNS)]
)
def test_egos_cross_it_by_its_rules_and_arrive(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, turn: str, count: int, until_s: float, controller: str
) -> None:
    settings = {"turn": turn, "ego_count": str(count)}
    row, last = _driven(tmp_path, monkeypatch, controller, settings, until_s)
    assert row["n_vehicle_overlaps_ego_closed"] == "0"
    assert row["n_collisions"] == "0"
    assert len(last) == count
    assert last["edge"].str.endswith("_out").all()
    assert last["time_s"].max() < until_s - 0.5


@pytest.mark.parametrize("controller", ["vo_mpc", AEB_TOO])
def test_an_ego_with_no_car_ahead_waits_at_the_red_light_and_drives_on_at_green(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, controller: str
) -> None:
    """It comes in 90 m before the junction, and waits for the last seconds of red."""
    _, last = _driven(tmp_path, monkeypatch, controller, {"vehicles_per_hour": "0"}, 97.0, 75.0, LEFT)
    assert RedLightWatch.waited == {"ego_0"}
    assert last["edge"].tolist() != [LEFT[0]]


@pytest.mark.slow
def test_with_no_car_ahead_the_ego_itself_waits_at_a_red_light(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = {"turn": "left", "ego_count": "2", "ego_headway_s": "10", "vehicles_per_hour": "0"}
    _driven(tmp_path, monkeypatch, "vo_mpc", settings, 182.0)
    assert RedLightWatch.waited == {"ego_1"}


def _driven(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    controller: str,
    settings: Mapping[str, str],
    until_s: float,
    warmup_s: float = WARMUP_S,
    ego_route: tuple[str, ...] = (),
) -> tuple[Mapping[str, str], pd.DataFrame]:
    """Return the row of ``runs.csv`` and the last rows of the egos of a run in which no red light is run."""
    monkeypatch.setattr("cosim.running.simulation.Recorder", RedLightWatch)
    monkeypatch.setattr(RedLightWatch, "passed", [], raising=False)
    monkeypatch.setattr(RedLightWatch, "waited", set(), raising=False)
    if ego_route:
        settings = {**settings, "ego_count": "1"}
    outcome = execute(
        RunRequest(
            "signalised_junction",
            controller,
            settings={**settings, "warmup_s": str(warmup_s)},
            duration_s=until_s - warmup_s,
            ego_route=ego_route,
            out=tmp_path / "run",
        )
    )
    assert outcome.invalid_reason == ""
    assert RedLightWatch.passed == []
    assert outcome.row is not None
    return outcome.row, pd.read_parquet(tmp_path / "run/egos.parquet").groupby("ego_id").tail(1)
