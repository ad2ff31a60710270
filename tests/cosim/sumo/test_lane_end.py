"""Egos that could wait for ever: at the end of a lane that leads off their route, and anywhere: runs in SUMO."""

import csv
import json
from pathlib import Path

import pandas as pd
import pytest

from cosim.cli import main
from cosim.running.request import RunRequest
from cosim.running.simulation import run
from cosim.sumo.stranded import MISSED, STOOD
from sumo_scenarios.preparation import SOONEST_TELEPORT_S

from . import built

pytestmark = pytest.mark.sumo

NODES = (
    '<node id="w" x="-100" y="0"/><node id="j" x="0" y="0" type="{type}"/><node id="e" x="150" y="0"/>'
    '<node id="s" x="0" y="-150"/>'
)
EDGES = (
    '<edge id="wj" from="w" to="j" numLanes="2" sidewalkWidth="2"/>'
    '<edge id="jw" from="j" to="w" sidewalkWidth="2"/>'
    '<edge id="je" from="j" to="e" sidewalkWidth="2"/><edge id="js" from="j" to="s" sidewalkWidth="2"/>'
)
CONNECTIONS = (
    '<connection from="wj" to="js" fromLane="1" toLane="1"/>'
    '<connection from="wj" to="je" fromLane="2" toLane="1"/><crossing node="j" edges="wj jw" priority="true"/>'
)
"""The right lane leads south only, and a crossing is right behind its end."""


WAY_BACK = (
    '<edge id="sj" from="s" to="j" sidewalkWidth="2"/>',
    '<connection from="js" to="sj"/><connection from="sj" to="je"/>',
)
"""Edges and connections by which a car that went south comes back and goes east."""
BESIDE = (
    '<vType id="long" length="60"/><vehicle id="b" type="long" depart="0" departLane="2" departPos="{0}">'
    '<route edges="wj je"/><stop lane="wj_2" endPos="{0}" duration="1000"/></vehicle>'
)
STUCK = '<vehicle id="a" depart="0" departLane="1" departPos="60"><route edges="wj je"/></vehicle>'
"""Nobody lets it into the lane beside it, where its route goes on."""
AHEAD = (
    '<vehicle id="a" depart="0" departLane="1" departPos="80">'
    '<route edges="wj js"/><stop lane="wj_1" endPos="80" duration="1000"/></vehicle>'
)


def build(
    folder: Path,
    junction: str,
    position_m: float,
    depart_s: float = 0.0,
    way_back: tuple[str, str] = ("", ""),
    others: str = "",
) -> Path:
    """Return a configuration whose only ego departs in the right lane, so far along it, and goes east."""
    built.network(folder, NODES.format(type=junction), EDGES + way_back[0], CONNECTIONS + way_back[1])
    ego = (
        f'<vehicle id="v" depart="{depart_s}" departLane="1" departPos="{position_m}" '
        'departSpeed="0"><route edges="wj je"/></vehicle>'
    )
    return configured(folder, others + ego, 0.5)


def configured(folder: Path, vehicles: str, step_s: float) -> Path:
    """Return a configuration with these vehicles on the network in a folder."""
    (folder / "n.rou.xml").write_text(f"<routes>{vehicles}</routes>")
    configuration = folder / "n.sumocfg"
    configuration.write_text(
        '<configuration><input><net-file value="n.net.xml"/><route-files value="n.rou.xml"/></input>'
        f'<time><step-length value="{step_s}"/></time></configuration>'
    )
    return configuration


def stands(configuration: Path, duration_s: float) -> Path:
    """Let the ego stand for so long where it departs, and return the run's folder."""
    out = configuration.parent / "run"
    result = run(
        RunRequest(
            str(configuration),
            "constant_speed",
            settings={"speed_mps": "0"},
            duration_s=duration_s,
            ego_vehicle="v",
            out=out,
        )
    )
    assert result.valid, result.invalid_reason
    return out


@pytest.mark.parametrize(("junction", "depart_s"), [("priority", 0.0), ("traffic_light", 76.0)])
def test_an_ego_leaves_a_lane_that_leads_elsewhere_over_the_crossing_at_its_end(
    tmp_path: Path, junction: str, depart_s: float
) -> None:
    """It stood there for ever: no change of lane began where it would have led over a crossing."""
    configuration = build(tmp_path, junction, 86.0, depart_s)
    out = tmp_path / "run"
    result = run(RunRequest(str(configuration), "vo_mpc", duration_s=200.0, ego_vehicle="v", out=out))
    assert result.valid, result.invalid_reason
    egos = pd.read_parquet(out / "egos.parquet")
    assert egos["edge"].iloc[-1] == "je"
    assert not egos["handed_back"].any()
    entering = egos[egos["edge"].str.startswith(":j")].iloc[0]
    assert entering["signal_ahead"] != "red"
    if junction == "traffic_light":
        assert (egos["signal_ahead"] == "red").any(), "the light of the way beside it is seen"


@pytest.mark.long
def test_an_ego_that_stands_for_too_long_is_handed_back_and_driven_on_by_sumo(tmp_path: Path) -> None:
    out = stands(build(tmp_path, "priority", 20.0), STOOD + 120.0)
    assert json.loads((out / "run.json").read_text())["egos_given_up"] == ["v"]
    assert main(["analyse", str(out)]) == 0
    with (out / "runs.csv").open(encoding="utf-8", newline="") as file:
        assert [row["n_egos_given_up"] for row in csv.DictReader(file)] == ["1"]
    egos = pd.read_parquet(out / "egos.parquet")
    driven = egos[~egos["handed_back"]]
    assert driven["time_s"].iloc[-1] == pytest.approx(STOOD, abs=1.0)
    assert not egos.loc[egos["handed_back"], "planned"].iloc[1:].any()
    assert egos["edge"].iloc[-1] == "je"


@pytest.mark.long
def test_an_ego_that_nobody_lets_in_takes_another_way_to_its_destination(tmp_path: Path) -> None:
    """It stood there for 240 s, then SUMO's driver for ever, and whoever was behind it as long."""
    configuration = build(tmp_path, "priority", 60.0, 1.0, WAY_BACK, BESIDE.format(85.0))
    out = tmp_path / "run"
    result = run(RunRequest(str(configuration), "vo_mpc", duration_s=200.0, ego_vehicle="v", out=out))
    assert result.valid, result.invalid_reason
    description = json.loads((out / "run.json").read_text())
    assert (description["egos_on_detours"], description["egos_given_up"]) == (["v"], [])
    egos = pd.read_parquet(out / "egos.parquet")
    assert list(dict.fromkeys(edge for edge in egos["edge"] if not edge.startswith(":"))) == [
        "wj",
        "js",
        "sj",
        "je",
    ]
    causes = set(egos.loc[egos["intervention"], "intervention_cause"])
    assert causes <= {"tight_bend"}, "where it turns back in the south"


@pytest.mark.parametrize(("others", "detours"), [("", ["v"]), (AHEAD, [])])
def test_only_the_first_on_a_lane_that_leads_elsewhere_takes_another_way(
    tmp_path: Path, others: str, detours: list[str]
) -> None:
    """However far before the end of the lane it waits; the others wait for the first."""
    out = stands(build(tmp_path, "priority", 40.0, 1.0, WAY_BACK, others), MISSED + 10.0)
    assert json.loads((out / "run.json").read_text())["egos_on_detours"] == detours


def split(folder: Path, middle: float, vehicles: str) -> Path:
    """Return a configuration in which lanes are split off before the junction, so far from its middle."""
    nodes = NODES.format(type="priority") + f'<node id="m" x="{middle}" y="0" type="priority" radius="2"/>'
    edges = EDGES.replace('id="wj" from="w"', 'id="mj" from="m"') + WAY_BACK[0]
    edges += '<edge id="wm" from="w" to="m" numLanes="2" sidewalkWidth="2"/>'
    built.network(folder, nodes, edges, (CONNECTIONS + WAY_BACK[1]).replace("wj", "mj"))
    return configured(folder, vehicles, 0.5)


EGO = (
    '<vehicle id="v" depart="12" departLane="1" departPos="{}" departSpeed="0"><route edges="wm mj je"/>'
    "</vehicle>"
)


@pytest.mark.parametrize(("middle", "position_m", "detours"), [(-20, -3, 1), (-20, -40, 0), (-60, -3, 0)])
def test_a_lane_that_leads_elsewhere_after_the_next_short_edge_counts(
    tmp_path: Path, middle: float, position_m: float, detours: int
) -> None:
    """Not far before it, nor before a long edge."""
    out = stands(split(tmp_path, middle, EGO.format(position_m)), MISSED + 20.0)
    assert json.loads((out / "run.json").read_text())["egos_on_detours"] == ["v"] * detours


@pytest.mark.long
def test_an_ego_that_waits_where_the_number_of_lanes_changes_takes_another_way(tmp_path: Path) -> None:
    """Its front is in a junction of 4 m there: it stood for 240 s."""
    beside = (
        '<vType id="long" length="60"/><vehicle id="b" type="long" depart="0" departLane="2" departPos="78">'
        '<route edges="wm mj je"/><stop lane="mj_2" endPos="4" duration="1000"/></vehicle>'
    )
    configuration, out = split(tmp_path, -20, beside + EGO.format(30)), tmp_path / "run"
    result = run(RunRequest(str(configuration), "vo_mpc", duration_s=110.0, ego_vehicle="v", out=out))
    assert result.valid, result.invalid_reason
    egos = pd.read_parquet(out / "egos.parquet")
    waits = egos.loc[egos["speed_mps"] < 0.01, "edge"]
    assert waits.iloc[len(waits) // 2].startswith(":m")
    edges = dict.fromkeys(edge for edge in egos["edge"] if not edge.startswith(":"))
    assert list(edges) == ["wm", "mj", "js", "sj", "je"]


@pytest.mark.long
def test_a_vehicle_of_sumo_that_blocks_the_road_is_teleported_and_an_ego_is_not(tmp_path: Path) -> None:
    """Not before the ego behind it was handed back, however early the configuration has it."""
    configuration = build(tmp_path, "priority", 40.0, 1.0, others=BESIDE.format(92.0) + STUCK)
    text = configuration.read_text().replace(
        "</time>", '</time><processing><time-to-teleport value="9"/></processing>'
    )
    configuration.write_text(text)
    out = tmp_path / "run"
    result = run(
        RunRequest(str(configuration), "aeb", duration_s=SOONEST_TELEPORT_S + 20.0, ego_vehicle="v", out=out)
    )
    assert result.valid, result.invalid_reason
    description = json.loads((out / "run.json").read_text())
    assert (description["egos_given_up"], description["n_others_teleported"]) == (["v"], 1)
    neighbours = pd.read_parquet(out / "neighbours.parquet")
    assert neighbours.loc[neighbours["object_id"] == "a", "time_s"].max() > SOONEST_TELEPORT_S - 1.0
