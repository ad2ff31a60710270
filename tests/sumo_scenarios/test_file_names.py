"""Folders and files whose names SUMO's programs would take apart at a comma, or decode at a per cent sign."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import sumo

from sumo_scenarios.file_names import plain_name
from sumo_scenarios.library import LIBRARY, load, prepare

PROGRAMS = Path(sumo.SUMO_HOME) / "bin"
STRANGE = "Main St, north; 100%25 (1)"
CAR = '<routes><vehicle id="v" depart="0"><route edges="A0A1"/></vehicle></routes>'
pytestmark = pytest.mark.sumo


@pytest.fixture
def street(tmp_path: Path) -> Path:
    """A folder of that name, with a network and demand that has a file of types in another folder included."""
    folder = tmp_path / STRANGE
    (folder / "more, types").mkdir(parents=True)
    command = [str(PROGRAMS / "netgenerate"), "--grid", "--grid.number", "2", "-o", "the town.net.xml"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    (folder / "more, types" / "types.xml").write_text('<additional><vType id="own"/></additional>')
    (folder / "types.add.xml").write_text('<additional><include href="more, types/types.xml"/></additional>')
    (folder / "a car.rou.xml").write_text(CAR.replace('id="v"', 'id="v" type="own"'))
    return folder


def _runs(options: tuple[str, ...]) -> None:
    """Let SUMO read what a run reads, in a process of its own."""
    environment = {**os.environ, "SUMO_HOME": sumo.SUMO_HOME}
    command = [str(PROGRAMS / "sumo"), *options, "--end", "5"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr


def test_a_folder_may_have_a_comma_and_a_per_cent_sign_in_its_name(street: Path, tmp_path: Path) -> None:
    (street / "town.sumocfg").write_text(
        '<configuration><net-file value="the town.net.xml"/><route-files value="a car.rou.xml"/>'
        '<additional-files value="types.add.xml"/></configuration>'
    )
    _runs(prepare(load(str(street / "town.sumocfg")), 1, tmp_path / "work").options)


def test_a_configuration_that_sumo_saved_is_read_as_sumo_reads_it(street: Path, tmp_path: Path) -> None:
    names = ["-n", "the town.net.xml", "-r", "a car.rou.xml", "-a", "types.add.xml"]
    saving = [str(PROGRAMS / "sumo"), *names, "--save-configuration", "town.sumocfg"]
    subprocess.run(saving, cwd=street, check=True, capture_output=True)
    assert "the%20town.net.xml" in (street / "town.sumocfg").read_text()
    _runs(prepare(load(str(street / "town.sumocfg")), 1, tmp_path / "work").options)


def test_a_scenario_of_plain_sources_may_lie_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COSIM_CACHE_DIR", str(tmp_path / "cache, 100%25"))
    folder = tmp_path / STRANGE / "midblock_zebra"
    shutil.copytree(LIBRARY / "midblock_zebra", folder)
    shutil.copytree(LIBRARY / "road_users", folder.parent / "road_users")
    _runs(prepare(load(str(folder)), 1, tmp_path / "work").options)


def test_a_plain_name_stays_and_another_becomes_a_link_to_the_same_file(tmp_path: Path) -> None:
    plain = tmp_path / "a b;c.net.xml"
    strange = tmp_path / "a,b%20c.net.xml.gz"
    strange.write_text("x")
    assert plain_name(plain, tmp_path) == str(plain)
    link = Path(plain_name(strange, tmp_path))
    assert link.name.endswith(".net.xml.gz")
    assert link.samefile(strange)
    assert plain_name(strange, tmp_path) == str(link)  # one link is enough
