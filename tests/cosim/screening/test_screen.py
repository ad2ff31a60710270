"""``cosim screen`` as a user types it, with real SUMO."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from analysis.files import read_csv
from analysis.metrics.injury_risk_rosen2009 import risk
from cosim.errors import InputError
from cosim.screening.clock import seconds
from sumo_scenarios.sumo_installation import netconvert
from tests.browsers import started
from tests.cosim.cli.commands import ended

CARS = '<routes><flow id="car" begin="0" end="200" period="4" from="A0B0" to="B1A1"/></routes>'
DEMAND = """<routes>
  <flow id="car" begin="0" end="200" period="4" from="A0B0" to="B1A1"/>
  <personFlow id="car" begin="0" end="200" period="3" departPos="80"><walk from="A0B0" to="B1B0"/></personFlow>
</routes>"""
CONFIGURATION = """<configuration>
  <input><net-file value="t.net.xml"/><route-files value="t.rou.xml"/></input>
  <time><begin value="0"/><end value="200"/></time>
</configuration>"""


def town(folder: Path, crossings: bool = True) -> Path:
    """Write a network of four junctions with its demand, and return the configuration."""
    guess = ["--crossings.guess", "--sidewalks.guess"] if crossings else []
    net = folder / "t.net.xml"
    command = [
        str(netconvert().with_name("netgenerate")),
        "--grid",
        "--grid.number",
        "2",
        *guess,
        "-o",
        str(net),
    ]
    subprocess.run(command, check=True, capture_output=True)
    (folder / "t.rou.xml").write_text(DEMAND)
    path = folder / "t.sumocfg"
    path.write_text(CONFIGURATION)
    return path


FEW = ("--rows", 4)
"""Of a report: so many encounters are listed and have a replay."""
LIMITS = ("--from", "00:00:20", "--to", "60", "--min-pedestrians", 5)


@pytest.fixture(scope="module")
def screened(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, CompletedProcess[str]]:
    """Return a folder with a town and its screening in ``out``, and what the command printed."""
    folder = tmp_path_factory.mktemp("screened")
    arguments = ("screen", town(folder), "--seeds", "1-2", "--jobs", 2, "--out", folder / "out")
    return folder, ended(*arguments, *LIMITS)


@pytest.fixture(scope="module")
def reported(screened: tuple[Path, CompletedProcess[str]], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the screening with its report."""
    out = shutil.copytree(screened[0] / "out", tmp_path_factory.mktemp("reported") / "out")
    ended("report", out, *FEW)
    return out


@pytest.mark.long
@pytest.mark.sumo
def test_a_town_is_ranked_and_the_same_command_ranks_it_again(
    screened: tuple[Path, CompletedProcess[str]], tmp_path: Path
) -> None:
    out = shutil.copytree(screened[0], tmp_path, dirs_exist_ok=True) / "out"
    told = screened[1]
    rows = read_csv(out / "crossings.csv")
    used = read_csv(out / "crossing_exposure.csv")
    assert len(used) == 2 * len(rows) > 0
    ranked = [row for row in rows if row["rank"]]
    assert rows[: len(ranked)] == ranked
    assert 0 < len(ranked) < len(rows)
    assert f"{len(rows)} crossings, {len(ranked)} ranked over 2 seeds" in told.stdout
    assert "no projection" in told.stderr
    assert "steps of 0.1 s are simulated" in told.stderr  # a configuration without a step length has 1 s
    assert not (out / "crossings.geojson").exists()
    for row in rows:
        walks = sum(int(one["n_pedestrians"]) for one in used if one["crossing_id"] == row["crossing_id"])
        assert float(row["observed_h"]) == pytest.approx(2 * 40.0 / 3600.0, abs=1e-3)
        assert float(row["pedestrians_per_h"]) == pytest.approx(walks / float(row["observed_h"]), rel=1e-4)
        assert (row["conflicts_per_1000_ped"] == "") == (walks == 0)
        assert bool(row["rank"]) == (walks >= 5)
    traffic = read_csv(out / "traffic_encounters.csv")
    conflicts = sum(row["severity"] in ("serious", "severe", "collision") for row in traffic)
    assert sum(int(row["n_conflicts"]) for row in rows) == conflicts
    before = (out / "crossings.csv").read_bytes()
    again = ("screen", screened[0] / "t.sumocfg", "--seeds", "1-2", "--jobs", 2, "--out", out)
    ended(*again, *LIMITS)
    assert (out / "crossings.csv").read_bytes() == before
    assert {row["ranked_by"] for row in rows} == {"risk"}
    ended(*again, *LIMITS, "--rank-by", "conflicts")
    by_conflicts = read_csv(out / "crossings.csv")
    assert {row["ranked_by"] for row in by_conflicts} == {"conflicts"}
    assert [row["rank"] for row in by_conflicts] == [row["rank_by_conflicts"] for row in by_conflicts]
    for row in rows:
        assert row["rank"] == row["rank_by_risk"]
        met = [
            risk(3.6 * float(one["conflicting_speed_mps"]))
            for one in traffic
            if (one["crossing_id"], one["entered"]) == (row["crossing_id"], "1")
            and one["conflicting_speed_mps"]
        ]
        assert (row["p_fatal_mean"] == "") == (not met)
        assert not met or float(row["p_fatal_mean"]) == pytest.approx(sum(met) / len(met), rel=1e-3)
    refused = ended(*again, *LIMITS, "--rank-by", "wind", code=2).stderr
    assert "wind" in refused
    assert "risk" in refused
    ended("verify", out)
    (out / "crossings.csv").write_text("altered")
    assert "crossings.csv" in ended("verify", out, code=3).stderr


@pytest.mark.long
@pytest.mark.sumo
def test_the_report_of_a_screening_is_a_map_whose_crossings_lead_to_their_rows(
    reported: Path,
) -> None:
    out = reported
    page = (out / "report.html").read_text("utf-8")
    rows = read_csv(out / "crossings.csv")
    assert "Which crossings of t are dangerous?" in page
    assert page.count("<circle") == len(rows)
    for row in rows:
        name = row["crossing_id"]
        assert f'href="#crossing-{name}"' in page
        assert f'<tr id="crossing-{name}"' in page
    assert page.count("crossing c0") == sum(row["rank"] == "" for row in rows)
    found = re.findall(r"(\S+) and (\S+), seed (\d+), at", page)
    conflicts = [
        (row["vehicle_id"], row["ped_id"], row["seed"])
        for row in read_csv(out / "traffic_encounters.csv")
        if row["severity"] in ("serious", "severe", "collision")
    ]
    assert found
    replays = re.findall(r'href="#replay=([^"]+)"', page)
    assert len(replays) == len(found)
    assert all((out / "report_data" / "replays" / f"{key}.js").is_file() for key in replays)
    assert {*found} <= {*conflicts}
    ended("report", out, *FEW)
    assert (out / "report.html").read_text("utf-8") == page
    ended("verify", out)


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.browser
def test_the_report_of_a_screening_prints_on_one_sheet(reported: Path) -> None:
    with started() as browser:
        page = browser.new_page()
        page.goto((reported / "report.html").as_uri())
        printed = page.pdf(prefer_css_page_size=True)
    assert re.findall(rb"/Count (\d+)", printed) == [b"1"]


@pytest.mark.sumo
def test_bad_input_is_refused_in_one_line(tmp_path: Path) -> None:
    told = ended("screen", town(tmp_path, crossings=False), "--out", tmp_path / "out", code=2).stderr
    assert "the network has no crossings to rank" in told
    told = ended("screen", "midblock_zebra", "--from", "noon", code=2).stderr
    assert "--from noon: expected a time such as 07:30" in told
    told = ended("screen", "midblock_zebra", "--to", "60", "--set", "duration_s=30", code=2).stderr
    assert "--to and --set duration_s: expected only one of them" in told
    told = ended("screen", "nowhere.sumocfg", code=2).stderr
    assert "nowhere.sumocfg" in told
    assert not (tmp_path / "out").exists()


@pytest.mark.long
@pytest.mark.sumo
def test_an_alternative_is_compared_crossing_by_crossing(tmp_path: Path) -> None:
    configuration, out = town(tmp_path), tmp_path / "out"
    slow = tmp_path / "slow.sumocfg"
    net = (tmp_path / "t.net.xml").read_text()
    (tmp_path / "slow.net.xml").write_text(net.replace('speed="13.89"', 'speed="5.00"'))
    slow.write_text(CONFIGURATION.replace("t.net.xml", "slow.net.xml"))
    arguments = ("screen", configuration, "--seeds", "1-3", "--to", 40, "--against", slow, "--out", out)
    told = ended(*arguments, "--min-pedestrians", 5)
    rows = {(row["crossing_id"], row["metric"]): row for row in read_csv(out / "crossing_changes.csv")}
    speed = rows["total", "vehicle_speed_mean_mps"]
    assert (speed["changed"], speed["n_pairs"]) == ("1", "3")
    assert float(speed["alt_mean"]) < 5.1 < float(speed["base_mean"])
    assert "vehicle_speed_mean_mps" in told.stdout
    assert "the alternative moves trips" in told.stderr
    assert (out / "against" / "crossings.csv").is_file()
    # Both sides are what their own tables say.
    for folder, side in ((out, "base_mean"), (out / "against", "alt_mean")):
        for row in read_csv(folder / "crossings.csv"):
            for metric in ("pedestrians_per_h", "conflicts_per_1000_ped", "vehicle_speed_mean_mps"):
                value = rows[row["crossing_id"], metric][side]
                assert (value == "") == (row[metric] == "")
                assert not value or float(value) == pytest.approx(float(row[metric]), rel=1e-3)
    before = (out / "crossing_changes.csv").read_bytes()
    ended(*arguments)
    assert (out / "crossing_changes.csv").read_bytes() == before
    ended("report", out, *FEW)
    page = (out / "report.html").read_text("utf-8")
    assert 'id="changes"' in page
    assert "against/runs" not in page  # what is listed and replayed is the base
    ended("verify", out)


@pytest.mark.sumo
def test_an_alternative_that_cannot_be_compared_is_refused(tmp_path: Path) -> None:
    configuration = town(tmp_path)
    net = (tmp_path / "t.net.xml").read_text()
    (tmp_path / "other.net.xml").write_text(net.replace("_c", "_d"))
    other = tmp_path / "other.sumocfg"
    other.write_text(CONFIGURATION.replace("t.net.xml", "other.net.xml"))
    told = ended("screen", configuration, "--against", other, "--out", tmp_path / "out", code=2).stderr
    assert "no crossing in common" in told
    told = ended("screen", configuration, "--alt", "ego_share=0.2", "--out", tmp_path / "out", code=2).stderr
    assert "a screening has no egos" in told
    told = ended("screen", configuration, "--alt", "wind=3", "--out", tmp_path / "out", code=2).stderr
    assert "wind" in told
    assert not (tmp_path / "out").exists()


@pytest.mark.long
@pytest.mark.sumo
def test_a_town_without_pedestrians_has_no_rates(tmp_path: Path) -> None:
    configuration, out = town(tmp_path), tmp_path / "out"
    (tmp_path / "t.rou.xml").write_text(CARS)
    told = ended("screen", configuration, "--seeds", 1, "--to", 20, "--out", out)
    assert "nobody walked over a crossing" in told.stderr
    assert "no interval with a single seed" in told.stderr
    rows = read_csv(out / "crossings.csv")
    undefined = ("conflicts_per_1000_ped", "rank", "risk_per_1000_ped", "p_fatal_mean", "p_fatal_expected")
    assert {row[name] for row in rows for name in undefined} == {""}


def test_times_of_day_are_read() -> None:
    assert [seconds(text, "--to") for text in ("7:30", "07:30:15", "27000", "0.5")] == [
        27000,
        27015,
        27000,
        0.5,
    ]
    for text in ("7:60", "-5", "nan", "inf"):
        with pytest.raises(InputError, match="--to"):
            seconds(text, "--to")
