"""A functional mock-up unit as a controller: units that the tests build, and everything wrong with one."""

from __future__ import annotations

import shutil
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from pythonfmu import FmuBuilder
from pythonfmu3 import FmuBuilder as FmuBuilder3

import cosim
from controllers import catalog
from controllers.interface import Controller, Plan
from controllers.outside.addresses import files
from controllers.outside.fmu.driver import FmuController
from controllers.outside.fmu.unit import Unit, UnitError
from tests.controllers.scenes import Car, ego, perception
from tests.documentation.command_blocks import fences

PAGE = "docs/outside-controllers.md"
# 8 m/s, 25 m behind a car that drives 6 m/s.
SCENE = perception(ego(8.0), cars=[Car(33.05, 0.0, 6.0)])
FMI3 = """
from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability, Fmi3Status, Fmi3StepResult


class Acc3(Fmi3Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = 0.0
        self.speed = 0.0
        self.a_des = 0.0
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous)
        )
        self.register_variable(Float64("speed", causality=Fmi3Causality.input))
        self.register_variable(Float64("a_des", causality=Fmi3Causality.output))

    def do_step(self, current_time, step_size):
        self.a_des = 5.0 - self.speed
        return True
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the unit of the page, its mapping, one that fails and one of FMI 3.0."""
    folder = tmp_path_factory.mktemp("units")
    code = next(one for one in fences(PAGE, "py") if "pythonfmu" in one)
    (folder / "acc.py").write_text(code)
    (folder / "Acc.toml").write_text(*fences(PAGE, "toml"))
    bad = code.replace("class Acc(", "class Bad(").replace("return True", "return current_time < 0.05")
    (folder / "bad.py").write_text(bad)
    shutil.copy(folder / "Acc.toml", folder / "Bad.toml")
    for name in ("acc", "bad"):
        FmuBuilder.build_FMU(folder / f"{name}.py", dest=folder)
    (folder / "acc3.py").write_text(FMI3)
    FmuBuilder3.build_FMU(folder / "acc3.py", dest=folder)
    (folder / "Acc3.toml").write_text(
        '[inputs]\nspeed = { number = "speed_mps", scale = 0.5 }\n[outputs]\nacceleration_mps2 = "a_des"\n'
    )
    return folder


@pytest.fixture
def build() -> Iterator[Callable[..., FmuController]]:
    every: list[FmuController] = []

    def made(path: Path, **values: Any) -> FmuController:
        one: Controller = catalog.build(f"fmu:{path}", **values)
        assert isinstance(one, FmuController)
        every.append(one)
        return one

    yield made
    for one in every:
        one.close()


def ask(controller: FmuController) -> Plan:
    return controller.plan(SCENE, controller.decide(SCENE))


def test_a_unit_of_fmi_2_drives_by_its_mapping(built: Path, build: Callable[..., FmuController]) -> None:
    plan = ask(build(built / "Acc.fmu"))
    # Free: 0.5 (13.89 − 8); behind the car: 0.2 (25 − 2 − 1.8 · 8) + 0.6 (6 − 8) = 0.52.
    assert plan.command.acceleration[0] == pytest.approx(0.52, abs=1e-4)
    assert len(plan.command.times) > 1  # cosim keeps the lane


def test_a_unit_of_fmi_3_drives_and_a_scale_converts(
    built: Path, build: Callable[..., FmuController]
) -> None:
    assert ask(build(built / "Acc3.fmu")).command.acceleration[0] == pytest.approx(5.0 - 0.5 * 8.0, abs=1e-4)


def test_a_parameter_of_the_mapping_is_set(
    built: Path, tmp_path: Path, build: Callable[..., FmuController]
) -> None:
    other = tmp_path / "other.toml"
    other.write_text((built / "Acc.toml").read_text().replace("1.8", "1.0"))
    plan = ask(build(built / "Acc.fmu", mapping=str(other)))
    assert plan.command.acceleration[0] == pytest.approx(0.52 + 0.2 * 0.8 * 8.0, abs=1e-4)


@pytest.mark.parametrize("name", ["my unit", "ann's"])
def test_the_files_of_a_unit_are_recorded_whatever_it_is_called(name: str, tmp_path: Path) -> None:
    for suffix in ("fmu", "toml"):
        (tmp_path / f"{name}.{suffix}").write_text(suffix)
    assert set(files(f"fmu:{tmp_path / name}.fmu")) == {f"{name}.fmu", f"{name}.toml"}


def test_a_unit_that_fails_is_one_line(built: Path, build: Callable[..., FmuController]) -> None:
    one = build(built / "Bad.fmu")
    ask(one)
    with pytest.raises(RuntimeError, match=r"Bad\.fmu: failed at 0\.10 s") as caught:
        ask(one)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('"ahead_gap_m"', '"ahead_gap"', r"inputs\.gap: no 'ahead_gap'; did you mean 'ahead_gap_m'"),
        ("gap =", "gaps =", "inputs: no 'gaps'; did you mean 'gap'"),
        ('"a_des"', '"brake"', "outputs: no 'brake'; the unit has the outputs a_des"),
        ("time_gap =", "delay =", "parameters: no 'delay'"),
        ("acceleration_mps2 =", "acceleration =", "outputs.acceleration_mps2: field required"),
        ("[inputs]", "[inputs", "not valid TOML"),
    ],
)
def test_a_wrong_mapping_is_one_line(built: Path, tmp_path: Path, before: str, after: str, said: str) -> None:
    wrong = tmp_path / "wrong.toml"
    wrong.write_text((built / "Acc.toml").read_text().replace(before, after))
    with pytest.raises(catalog.CatalogError, match=said) as caught:
        catalog.build(f"fmu:{built / 'Acc.fmu'}", mapping=str(wrong))
    assert "\n" not in str(caught.value)


def test_a_unit_for_another_platform_is_one_line(built: Path, tmp_path: Path) -> None:
    path = tmp_path / "windows.fmu"
    with zipfile.ZipFile(built / "Acc.fmu") as source, zipfile.ZipFile(path, "w") as target:
        for name in source.namelist():
            if "linux" not in name and "darwin" not in name:
                target.writestr(name, source.read(name))
    with pytest.raises(catalog.CatalogError, match=r"is for win64; this machine needs \w+"):
        catalog.build(f"fmu:{path}")


@pytest.mark.parametrize(
    ("content", "said"), [(None, "there is no such file"), (b"text", "is no functional")]
)
def test_what_is_no_unit_is_one_line(content: bytes | None, said: str, tmp_path: Path) -> None:
    path = tmp_path / "some.fmu"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(catalog.CatalogError, match=said):
        catalog.build(f"fmu:{path}")


def test_a_missing_mapping_says_what_is_expected(built: Path, tmp_path: Path) -> None:
    path = shutil.copy(built / "Acc.fmu", tmp_path / "alone.fmu")
    with pytest.raises(catalog.CatalogError, match=r"alone\.toml: cannot be read .* expected for instance"):
        catalog.build(f"fmu:{path}")


def test_without_fmpy_the_command_is_told(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fmpy", None)
    with pytest.raises(UnitError, match=r"pip install fmpy"):
        Unit(built / "Acc.fmu")


@pytest.mark.long
@pytest.mark.sumo
def test_a_unit_drives_in_sumo_and_gives_the_same_bytes_twice(built: Path, tmp_path: Path) -> None:
    settings = {"duration_s": 10.0, "warmup_s": 5.0, "ego_count": 1}
    runs = [
        cosim.run("midblock_zebra", controller=f"fmu:{built / 'Acc.fmu'}", out=tmp_path / name, **settings)  # type: ignore[arg-type]  # parameters of the scenario
        for name in ("one", "two")
    ]
    assert all(one.valid for one in runs)
    first, second = ((one.folder / "egos.parquet").read_bytes() for one in runs)
    assert first == second
    assert set(runs[0].description["controller_files"]) == {"Acc.fmu", "Acc.toml"}
