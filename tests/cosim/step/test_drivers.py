"""One controller for one ego."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

import cosim.step.drivers
from controllers.interface import Controller
from cosim.running.request import RunRequest
from cosim.running.simulation import run
from cosim.step import loop
from cosim.step.drivers import Departures, Drivers, seed_of
from cosim.step.world import Snapshot
from tests.cosim.step.tiny_world import SteadyDriver, TinyWorld


def test_every_ego_has_a_controller_of_its_own_that_stays() -> None:
    drivers = Drivers(lambda seed: SteadyDriver(), seed=1)
    assert drivers["a"] is drivers["a"]
    assert drivers["a"] is not drivers["b"]
    assert list(drivers) == ["a", "b"]


def test_an_egos_seed_follows_from_its_name_and_the_runs_seed_alone() -> None:
    seeds: list[int] = []

    def build(seed: int) -> Controller:
        seeds.append(seed)
        return SteadyDriver()

    several = Drivers(build, seed=3)
    assert len({id(several[name]) for name in ("x", "a")}) == 2
    assert Drivers(build, seed=3)["a"] is not None
    assert seeds[1] == seeds[2] == seed_of(3, "a")
    assert seeds[0] != seeds[1]
    assert seed_of(4, "a") != seed_of(3, "a")


def test_the_controller_of_an_ego_that_has_left_is_let_go_and_the_others_stay() -> None:
    world = TinyWorld(("a", "b"), steps=6)
    drivers = Drivers(lambda seed: SteadyDriver(), seed=1)
    held: list[list[str]] = []
    stays = drivers["b"]

    class OneLeaves(Departures):
        def stepped(self, snapshot: Snapshot) -> None:
            super().stepped(snapshot)
            held.append(sorted(drivers))
            if len(held) == 2:
                world.names = ("b",)

    loop.run(world, drivers, OneLeaves(drivers))
    assert held == [["a", "b"], ["a", "b"], ["b"], ["b"], ["b"], ["b"]]
    assert drivers["b"] is stays


@pytest.mark.long
@pytest.mark.sumo
def test_a_run_holds_the_controllers_of_no_more_egos_than_are_on_the_road(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held: list[tuple[int, int]] = []
    before = Departures.stepped

    def stepped(self: Departures, snapshot: Snapshot) -> None:
        before(self, snapshot)
        held.append((len(self._drivers), len(snapshot.egos)))

    monkeypatch.setattr(cosim.step.drivers.Departures, "stepped", stepped)
    settings = {"warmup_s": "20", "step_s": "0.5"}
    request = RunRequest("midblock_zebra", "aeb", 1, settings, duration_s=120.0, ego_share=0.2)
    result = run(dataclasses.replace(request, out=tmp_path / "run"))
    assert result.valid
    assert all(drivers <= egos for drivers, egos in held)
    assert result.description["n_egos"] > max(drivers for drivers, _ in held)
