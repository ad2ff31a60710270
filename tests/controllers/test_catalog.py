"""Names, parameters and refusals of the catalogue of controllers."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path

import pytest

from controllers import catalog
from controllers.interface import Controller

PLUGIN = '''
"""A driver from outside."""

from enum import StrEnum
from typing import Literal


class Mood(StrEnum):
    CALM = "calm"
    BRISK = "brisk"


class Driver:
    def __init__(self, given):
        self.given = given


def build(
    *, mood: Mood = Mood.CALM, count: int = 2, careful: bool = True, way: Literal["a", "b"] = "a",
    label: str = "x", reach_m: float | None = None, seed: int = 1,
):
    if count < 0:
        raise ValueError(f"count = {count} must be at least 0")
    return Driver(dict(locals()))
'''


@pytest.fixture
def plugin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """Install a controller through the entry-point group, and one that cannot be imported."""
    (tmp_path / "outside_driver.py").write_text(PLUGIN)
    monkeypatch.syspath_prepend(str(tmp_path))
    points = EntryPoints(
        [
            EntryPoint("outside", "outside_driver", catalog.ENTRY_POINT_GROUP),
            EntryPoint("broken", "no_such_module_at_all", catalog.ENTRY_POINT_GROUP),
            EntryPoint("sumo", "outside_driver", catalog.ENTRY_POINT_GROUP),
        ]
    )
    monkeypatch.setattr(catalog, "entry_points", lambda **wanted: points.select(**wanted))
    yield "outside"
    sys.modules.pop("outside_driver", None)


def _given(controller: Controller) -> dict[str, object]:
    given = controller.given  # type: ignore[attr-defined]  # the plug-in's own attribute
    assert isinstance(given, dict)
    return given


def _refusal(call: object, *arguments: object, **values: object) -> str:
    assert callable(call)
    with pytest.raises(catalog.CatalogError) as caught:
        call(*arguments, **values)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_the_files_of_the_strategies_are_the_names() -> None:
    assert {"aeb", "constant_speed", "sumo"} <= set(catalog.names())
    assert list(catalog.names()) == sorted(catalog.names())


def test_an_unknown_controller_is_refused_with_the_nearest_name_and_all_names() -> None:
    text = _refusal(catalog.build, "constant_sped")
    assert "did you mean 'constant_speed'?" in text
    assert "aeb" in text


def test_an_unknown_parameter_is_refused_with_the_nearest_name() -> None:
    assert "did you mean 'friction'?" in _refusal(catalog.parse, "aeb", {"fricton": "0.7"})
    assert "it has none" in _refusal(catalog.build, "sumo", speed=1)


def test_texts_become_values_of_the_default_s_type() -> None:
    assert catalog.parse("aeb", {"friction": " 0.7 ", "ramp_s": "0"}) == {"friction": 0.7, "ramp_s": 0.0}
    assert catalog.parse("constant_speed", {"speed_mps": "8"}) == {"speed_mps": 8.0}
    assert catalog.parse("constant_speed", {"speed_mps": "none"}) == {"speed_mps": None}


def test_a_wrong_type_is_refused() -> None:
    assert _refusal(catalog.parse, "aeb", {"friction": "icy"}) == (
        "controller 'aeb': friction = 'icy': expected a number"
    )
    assert "expected a number or none" in _refusal(catalog.build, "constant_speed", speed_mps="fast")
    assert "expected a number" in _refusal(catalog.build, "aeb", friction=True)
    assert "expected a finite number" in _refusal(catalog.parse, "aeb", {"friction": "nan"})


def test_a_value_out_of_range_is_refused() -> None:
    assert "friction = -1: expected more than 0" in _refusal(catalog.build, "aeb", friction=-1)
    assert "expected more than 0" in _refusal(catalog.build, "aeb", friction=0.0)
    assert "speed_mps = -3.0: expected at least 0 or none" in _refusal(
        catalog.build, "constant_speed", speed_mps=-3.0
    )


def test_a_plug_in_is_built_with_a_seed_and_all_kinds_of_parameters(plugin: str) -> None:
    assert plugin in catalog.names()
    assert catalog.describe(plugin) == "A driver from outside."
    assert "seed" not in catalog.parameters(plugin)
    texts = {"mood": "brisk", "count": "3", "careful": "no", "way": "b", "label": "y", "reach_m": "2.5"}
    given = _given(catalog.build(plugin, seed=42, **catalog.parse(plugin, texts)))
    assert given == {
        "mood": "brisk", "count": 3, "careful": False, "way": "b", "label": "y", "reach_m": 2.5, "seed": 42,
    }  # fmt: skip


def test_a_plug_in_s_values_are_checked_as_well(plugin: str) -> None:
    assert "'calm' or 'brisk'" in _refusal(catalog.parse, plugin, {"mood": "wild"})
    assert "'a' or 'b'" in _refusal(catalog.build, plugin, way="c")
    assert "a whole number" in _refusal(catalog.parse, plugin, {"count": "1.5"})
    assert "a whole number" in _refusal(catalog.build, plugin, count=True)
    assert "true or false" in _refusal(catalog.parse, plugin, {"careful": "maybe"})
    assert "count = -1 must be at least 0" in _refusal(catalog.build, plugin, count=-1)
    assert "no parameter 'seed'" in _refusal(catalog.parse, plugin, {"seed": "4"})


def test_a_plug_in_that_cannot_be_loaded_says_why(plugin: str) -> None:
    assert plugin
    assert "cannot be loaded: No module named" in _refusal(catalog.build, "broken")


def test_a_plug_in_does_not_replace_a_controller_of_the_repository(plugin: str) -> None:
    assert plugin
    assert "SUMO's own driver" in catalog.describe("sumo")


def test_a_plug_in_that_is_installed_later_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    os.utime(tmp_path, (1.0, 1.0))  # however fast the test is
    assert "late" not in catalog.names()
    (tmp_path / "late-1.dist-info").mkdir()
    (tmp_path / "late-1.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: late\nVersion: 1\n")
    (tmp_path / "late-1.dist-info" / "entry_points.txt").write_text("[cosim.controllers]\nlate = late\n")
    assert "late" in catalog.names()
