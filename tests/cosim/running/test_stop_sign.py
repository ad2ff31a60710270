"""An ego that comes to a stop sign: it stops, lets people who wait there cross, and drives on."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pandas as pd
import pytest
import sumo

from cosim.running.request import RunRequest
from cosim.running.simulation import run

pytestmark = [pytest.mark.sumo, pytest.mark.long]
PERSON = '<person id="walker" depart="0" departPos="82"><walk edges="A1B1 B1C1"/></person>'


@pytest.mark.parametrize("controller", ["vo_mpc", "aeb"])
def test_an_ego_stops_at_the_sign_and_drives_on(controller: str, tmp_path: Path) -> None:
    egos, _ = _driven(tmp_path, controller)
    before = egos[egos["edge"] == "B0B1"]
    assert before["speed_mps"].min() < 0.3
    assert before["front_y_m"].iloc[before["speed_mps"].argmin()] == pytest.approx(
        before["front_y_m"].max(), abs=4.0
    )
    assert egos["edge"].iloc[-1] == "B1B2"
    standing = egos[egos["speed_mps"] < 0.3]
    assert standing["time_s"].max() - standing["time_s"].min() < 5.0, "it does not wait for nobody"


@pytest.mark.parametrize(("courtesy_s", "person_first"), [(1.0, True), (0.0, False)])
def test_who_waits_at_the_sign_crosses_before_the_ego_unless_it_has_no_courtesy(
    courtesy_s: float, person_first: bool, tmp_path: Path
) -> None:
    """The crossing has no priority: SUMO's pedestrians wait until the ego really stands, or has passed."""
    egos, people = _driven(tmp_path, "vo_mpc", {"courtesy_s": str(courtesy_s)}, PERSON)
    waits = people[people["phase"] == "waiting"]
    steps = people.loc[people["phase"] == "crossing", "time_s"].min()
    enters = egos.loc[egos["edge"] != "B0B1", "time_s"].min()
    assert len(waits[waits["time_s"] < min(steps, enters)]) > 10, "they waited for the ego"
    assert (steps < enters) == person_first


def _driven(
    folder: Path, controller: str, settings: dict[str, str] | None = None, person: str = ""
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the ego's and the pedestrians' rows of a run over a junction of all-way stops."""
    netgenerate = Path(sumo.SUMO_HOME) / "bin" / "netgenerate"
    options = ["--grid", "--grid.number=3", "--grid.length=100", "--default-junction-type=allway_stop"]
    walks = ["--sidewalks.guess", "--crossings.guess", "--no-turnarounds"]
    net = ["-o", str(folder / "town.net.xml")]
    subprocess.run([str(netgenerate), *options, *walks, *net], check=True, capture_output=True)
    (folder / "town.rou.xml").write_text(
        f'<routes>{person}<vehicle id="ego" depart="0"><route edges="B0B1 B1B2"/></vehicle></routes>'
    )
    config = folder / "town.sumocfg"
    config.write_text(
        '<configuration><input><net-file value="town.net.xml"/><route-files value="town.rou.xml"/></input>'
        '<time><end value="60"/><step-length value="0.1"/></time></configuration>'
    )
    out = folder / "run"
    ran = run(
        RunRequest(str(config), controller=controller, ego_vehicle="ego", settings=settings or {}, out=out)
    )
    assert ran.valid, ran.invalid_reason
    neighbours = pd.read_parquet(out / "neighbours.parquet")
    return pd.read_parquet(out / "egos.parquet"), neighbours[neighbours["object_kind"] == "pedestrian"]
