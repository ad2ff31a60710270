"""Cases: files with mistakes in a folder, and the command that is given them."""

from __future__ import annotations

import json
import shutil
import subprocess
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sumo
from hypothesis import strategies as st

from sumo_scenarios.library import LIBRARY
from tests.fuzz.mutations import HOSTILE, changed_bytes, changed_tables, changed_xml

SHORT = ("--controller", "constant_speed", "--duration-s", "2", "--set", "warmup_s=0.5")
TWO_MORE = """
[[pedestrians]]
name = "line"
kind = "line"
lane = "east_0"
from_m = [60.0, -4.0]
to_m = [60.0, 8.0]
speed_mps = 1.4
start = { time_s = 0.0 }

[[pedestrians]]
name = "recorded"
kind = "trajectory"
file = "tracks.csv"
start_s = 0.1
"""
TRACKS = "time_s,x_m,y_m,person\n0,100,-5,a\n1,100,-4,a\n2,100,-3,a\n0,110,-5,b\n2,110,-4,b\n"
DEMAND = """<routes><vType id="car" vClass="passenger" length="4.5" maxSpeed="20"><param key="x" value="1"/></vType>
<route id="r" edges="A0A1 A1B1"/><vehicle id="mine" type="car" route="r" depart="0" departLane="1"/>
<flow id="f" type="car" begin="0" end="10" period="2" from="A0A1" to="A1B1"/>
<trip id="t" type="car" depart="1" from="B1A1" to="A1A0"><stop lane="B1A1_1" endPos="20" duration="1"/></trip>
<person id="p" depart="0"><walk from="A0A1" to="A1B1" departPos="5"/></person>
<personFlow id="q" begin="0" end="9" period="exp(0.5)"><walk edges="B1A1 A1A0"/></personFlow></routes>"""
ADDITIONAL = """<additional><inductionLoop id="l" lane="A0A1_1" pos="10" period="5" file="l.xml"/>
<busStop id="b" lane="A0A1_0" startPos="10" endPos="30"/><variableSpeedSign id="v" lanes="A0A1_1">
<step time="1" speed="5"/></variableSpeedSign><rerouter id="w" edges="A0A1"><interval begin="0" end="9">
<destProbReroute id="A1B1" probability="0.5"/></interval></rerouter><poi id="x" x="1" y="1"/></additional>"""
CONFIGURATION = """<configuration><input><net-file value="town.net.xml"/><route-files value="town.rou.xml"/>
<additional-files value="town.add.xml"/></input><time><begin value="0"/><end value="20"/>
<step-length value="0.1"/></time><processing><time-to-teleport value="100"/></processing>
<output><tripinfo-output value="t.xml"/></output></configuration>"""


TARGET = "target"
"""Not a command: the reading of a study and of criteria."""
CRITERIA = (TARGET, "midblock_zebra", "{}/criteria.toml")


@dataclass(frozen=True)
class Case:
    """A file with mistakes among others that are right."""

    kind: str
    file: str
    content: bytes
    command: tuple[str, ...]
    """Of the command line; ``{}`` is the folder."""


CRITERION = b"[[criteria]]\nscope = 'run'\nmetric = 'n_collisions'\noperator = '=='\nthreshold = 0\n"
STUDY = b"scenarios = ['midblock_zebra']\ncontrollers = ['sumo']\nseeds = '1-2'\n"


def without_mistakes() -> list[Case]:
    """Return a case of every kind in which nothing is wrong: it has to end with exit code 0."""
    run = ("run", "{}", *SHORT)
    town = ("run", "{}/town.sumocfg", *SHORT, "--ego-share", "1")
    scenario = (LIBRARY / "midblock_zebra" / "scenario.toml").read_bytes()
    return [
        Case("scenario", "scenario.toml", scenario, run),
        Case("tracks", "tracks.csv", TRACKS.encode(), run),
        Case("study", "study.toml", STUDY, (TARGET, "{}/study.toml")),
        Case("criteria", "criteria.toml", CRITERION, CRITERIA),
        Case("sumo", "town.rou.xml", DEMAND.encode(), town),
    ]


def prepare(folder: Path) -> None:
    """Write the files that are right: a folder for every kind."""
    shutil.copytree(LIBRARY / "road_users", folder / "road_users")
    for kind, name in (("scenario", "midblock_zebra"), ("pedestrians", "jaywalk_arterial")):
        shutil.copytree(LIBRARY / name, folder / kind)
    walkers = folder / "pedestrians" / "scenario.toml"
    walkers.write_text(walkers.read_text("utf-8") + TWO_MORE, "utf-8")
    (folder / "pedestrians" / "tracks.csv").write_text(TRACKS)
    town = folder / "sumo"
    town.mkdir()
    command = [str(Path(sumo.SUMO_HOME) / "bin" / "netgenerate"), "--grid", "--grid.number", "2", "-L", "2"]
    command += ["--sidewalks.guess", "--crossings.guess", "--tls.set", "B1", "-o", str(town / "town.net.xml")]
    subprocess.run(command, check=True, capture_output=True)
    for name, text in (("rou", DEMAND), ("add", ADDITIONAL)):
        (town / f"town.{name}.xml").write_text(text)
    (town / "town.sumocfg").write_text(CONFIGURATION)
    for kind in ("study", "criteria"):
        (folder / kind).mkdir()


def cases(folder: Path) -> st.SearchStrategy[Case]:
    """Return a strategy of cases, for the files that `prepare` has written."""
    scenario = tomllib.loads((folder / "scenario" / "scenario.toml").read_text("utf-8"))
    criteria = scenario["criteria"]
    walkers = tomllib.loads((folder / "pedestrians" / "scenario.toml").read_text("utf-8"))
    study = {
        "scenarios": ["midblock_zebra"],
        "controllers": ["sumo", "aeb"],
        "seeds": "1-3",
        "run_timeout_s": 60.0,
        "set": {"duration_s": 60.0},
        "vary": {"pedestrians_per_hour": [200, 600], "actuation": ["move"]},
        "criteria": criteria,
    }
    run = ("run", "{}", *SHORT)
    tables = changed_tables(walkers["pedestrians"][0]).map(lambda one: [one, *walkers["pedestrians"][1:]])
    people = st.one_of(
        tables, changed_tables({"all": walkers["pedestrians"]}).map(lambda one: one.get("all"))
    )
    return st.one_of(
        _toml("scenario", "scenario.toml", changed_tables(scenario), run),
        _toml("pedestrians", "scenario.toml", people.map(lambda some: {**walkers, "pedestrians": some}), run),
        _csv(TRACKS).map(lambda content: Case("tracks", "tracks.csv", content, run)),
        _toml("study", "study.toml", changed_tables(study), (TARGET, "{}/study.toml")),
        _toml("criteria", "criteria.toml", changed_tables({"criteria": criteria}), CRITERIA),
        _sumo(folder / "sumo"),
        _sumo(folder / "sumo"),
    )


@st.composite
def _toml(
    draw: st.DrawFn, kind: str, file: str, tables: st.SearchStrategy[Any], command: tuple[str, ...]
) -> Case:
    content = "".join(f"{_value(key)} = {_value(value)}\n" for key, value in draw(tables).items()).encode()
    if draw(st.integers(0, 9)) == 0:
        content = draw(changed_bytes(content))
    return Case(kind, file, content, command)


@st.composite
def _csv(draw: st.DrawFn, text: str) -> bytes:
    rows = [line.split(",") for line in text.splitlines()]
    for _ in range(draw(st.integers(1, 3))):
        row = draw(st.sampled_from(rows))
        row[draw(st.integers(0, len(row) - 1))] = draw(st.sampled_from(HOSTILE))
    content = "\n".join(",".join(row) for row in rows).encode()
    return draw(st.one_of(st.just(content), changed_bytes(content)))


@st.composite
def _sumo(draw: st.DrawFn, folder: Path) -> Case:
    file = draw(st.sampled_from(("town.net.xml", "town.rou.xml", "town.add.xml", "town.sumocfg")))
    text = (folder / file).read_text("utf-8")
    content = draw(changed_xml(text))
    if draw(st.integers(0, 4)) == 0:
        content = draw(changed_bytes(text.encode()))
    egos = draw(
        st.sampled_from((("--ego-share", "1"), ("--ego-vehicle", "mine"), ("--ego-route", "A0A1 A1B1")))
    )
    run = ("run", "{}/town.sumocfg", *SHORT, *egos)
    command = draw(st.sampled_from((run, run, ("inspect", "{}/town.sumocfg"))))
    return Case("sumo", file, content, command)


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_value(str(key))} = {_value(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value) if isinstance(value, str | bool) else str(value).replace("1e+308", "1e308")
