"""One controller for one ego."""

from __future__ import annotations

from controllers.interface import Controller
from cosim.drivers import Drivers, seed_of
from tests.cosim.tiny_world import SteadyDriver


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
