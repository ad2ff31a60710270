"""The pictures of the architecture show the code as it is."""

from __future__ import annotations

import importlib.util
import re
from itertools import combinations
from pathlib import Path
from types import ModuleType

import pytest

from studies.architecture.__main__ import PROJECT, pictures
from studies.architecture.digraph import cycles_merged, heights, without_shortcuts
from studies.architecture.layout import arrange
from studies.architecture.rooms import Box
from studies.architecture.step import read_step

LOOP = """
from dataclasses import dataclass
from typing import Protocol

@dataclass
class Sight:
    far: float

class World(Protocol):
    def look(self) -> Sight: ...
    def move(self) -> None: ...

class Driver(Protocol):
    def steer(self, sight: Sight, speed: float) -> None: ...

def run(world: World, driver: Driver) -> None:
    while True:
        for sight in [world.look()]:
            _told(driver, sight)
        world.move()

def _told(driver: Driver, sight: Sight) -> None:
    driver.steer(sight, 1.0)
"""


@pytest.fixture(scope="module")
def drawn() -> dict[str, str]:
    return pictures()


@pytest.mark.long
def test_the_committed_pictures_are_those_of_the_code(drawn: dict[str, str]) -> None:
    for name, picture in drawn.items():
        committed = (PROJECT / "docs/images" / name).read_text("utf-8")
        assert committed == picture, f"docs/images/{name} shows an earlier version of the code: make pictures"


@pytest.mark.long
def test_every_package_and_sub_package_is_in_the_picture_of_the_rooms(drawn: dict[str, str]) -> None:
    words = {word for text in re.findall(r"<text[^>]*>([^<]*)", drawn["rooms.svg"]) for word in text.split()}
    for package in ("cosim", "controllers", "analysis", "studies"):
        assert {package} | {path.parent.name for path in (PROJECT / package).glob("*/__init__.py")} <= words
    assert "sumo_scenarios" in words


@pytest.mark.long
@pytest.mark.parametrize("name", ["rooms.svg", "step.svg"])
def test_no_box_covers_another(drawn: dict[str, str], name: str) -> None:
    number = r"([\d.]+)"
    found = re.findall(
        rf'<rect class="box" x="{number}" y="{number}" width="{number}" height="{number}"', drawn[name]
    )
    boxes = [tuple(map(float, one)) for one in found]
    assert len(boxes) >= 8
    for (x, y, width, height), (u, v, wide, high) in combinations(boxes, 2):
        assert x + width < u or u + wide < x or y + height < v or v + high < y


def test_an_arrow_that_a_chain_replaces_is_left_out() -> None:
    assert without_shortcuts({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == {
        "a": {"b"},
        "b": {"c"},
        "c": set(),
    }
    assert heights({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == {"a": 2, "b": 1, "c": 0}


def test_rooms_that_import_each_other_are_one() -> None:
    groups = cycles_merged({"a": {"b"}, "b": {"c"}, "c": {"b"}})
    assert groups == [frozenset("a"), frozenset("bc")]


def test_arrows_that_need_not_cross_do_not_and_a_long_one_passes_beside_the_boxes() -> None:
    top, left, right, deep = Box(("top",)), Box(("left",)), Box(("right",)), Box(("deep",))
    layout = arrange(
        [[left, right], [top, deep]],
        [(left, deep), (right, top)],
        dict.fromkeys((top, left, right, deep), 50.0),
    )
    assert (layout.centres[left] < layout.centres[right]) == (layout.centres[deep] < layout.centres[top])
    layout = arrange(
        [[top], [left], [deep]], [(top, left), (top, deep)], dict.fromkeys((top, left, deep), 50.0)
    )
    ((point,),) = [route[1:-1] for route in layout.routes if route[-1] == deep]
    assert abs(layout.centres[point] - layout.centres[left]) > 25.0


def test_the_calls_of_a_step_are_read_in_the_order_of_execution(tmp_path: Path) -> None:
    calls = read_step(_module(tmp_path / "small_loop.py", LOOP))
    assert [(call.protocol, call.method, call.given) for call in calls] == [
        ("World", "look", ()),
        ("Driver", "steer", ("Sight",)),
        ("World", "move", ()),
    ]
    assert [call.loops for call in calls] == [
        ("while True",),
        ("while True", "for sight in [world.look()]"),
        ("while True",),
    ]


def _module(path: Path, text: str) -> ModuleType:
    path.write_text(text)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
