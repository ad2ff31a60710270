"""Who is near an ego, on networks and with names as users make them."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import libsumo
import pytest
import sumo

from cosim.conformance.stage import scene, wait_for
from cosim.running.request import RunRequest
from cosim.running.simulation import run
from cosim.sumo.network import Network
from cosim.sumo.present import Present, everybody_present
from cosim.sumo.surroundings import Observer

pytestmark = pytest.mark.sumo

HOME = Path(sumo.SUMO_HOME)
SHORT_LIVED = """<route id="r" edges="wx xe"/>
<vehicle id="ego" type="ego" route="r" depart="0" departLane="1" departPos="100" departSpeed="5"/>
<vehicle id="7" type="car" depart="0" departLane="2" departPos="120" departSpeed="10" arrivalPos="150">
<route edges="wx"/></vehicle>
<person id="7" type="walker" depart="0" departPos="130"><walk edges="wx" arrivalPos="189"/></person>"""


@pytest.fixture
def stage() -> Iterator[Any]:
    with scene("junction", SHORT_LIVED, step=1.0) as running:
        wait_for(running, "ego")
        yield running


def test_a_vehicle_that_has_arrived_is_not_there_though_a_person_of_its_name_is(stage: Any) -> None:
    observer = Observer(stage, Network({}, {}, {}, {}, {}), 1.0)
    observer.follow("ego")
    stage.simulationStep()
    seen = observer.read(("ego",), {}, everybody_present(stage))
    assert "7" in seen.cars.names
    while "7" in stage.vehicle.getIDList():
        stage.simulationStep()
    seen = observer.read(("ego",), {}, everybody_present(stage))
    assert seen.cars.names == ("ego",)
    assert "7" in stage.person.getIDList()


def test_a_vehicle_that_is_taken_off_the_road_is_gone_at_once(stage: Any) -> None:
    observer = Observer(stage, Network({}, {}, {}, {}, {}), 1.0)
    observer.follow("ego")
    stage.simulationStep()
    stage.vehicle.remove("7")
    # SUMO still has it among the results of the step, and refuses every question about it.
    everybody = Present(frozenset({"ego", "7"}), frozenset({"7"}))
    with pytest.raises(libsumo.TraCIException, match="'7' is not known"):
        observer.read(("ego",), {}, everybody)
    seen = observer.read(("ego",), {}, everybody_present(stage))
    assert seen.cars.names == ("ego",)


def test_another_route_is_noticed_on_the_same_lane(stage: Any) -> None:
    observer = Observer(stage, Network({}, {}, {}, {}, {}), 1.0)
    observer.follow("ego")
    stage.simulationStep()
    before = observer.read(("ego",), {}, everybody_present(stage)).cars
    stage.vehicle.setRoute("ego", ["wx", "xs"])
    stage.simulationStep()
    after = observer.read(("ego",), {}, everybody_present(stage)).cars
    assert before.route[before.names.index("ego")] != after.route[after.names.index("ego")]


@pytest.fixture(scope="module")
def town(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A grid with demand as randomTrips names it: cars and people have the same names."""
    folder = tmp_path_factory.mktemp("town")
    net = str(folder / "town.net.xml")

    def call(*arguments: str) -> None:
        subprocess.run(arguments, check=True, capture_output=True, cwd=folder)

    walks = ["--sidewalks.guess", "--crossings.guess", "--walkingareas", "--no-turnarounds"]
    grid = ["--grid", "--grid.number=3", "--grid.length=90", "--default-junction-type=priority"]
    call(str(HOME / "bin" / "netgenerate"), *grid, *walks, "-o", net)
    trips = [sys.executable, str(HOME / "tools" / "randomTrips.py"), "-n", net, "-e", "100", "--seed", "5"]
    call(*trips, "-o", "c.trips.xml", "-r", "cars.rou.xml", "--period", "2", "--validate")
    call(*trips, "-o", "people.xml", "--pedestrians", "--period", "2")
    (folder / "town.sumocfg").write_text(
        '<configuration><input><net-file value="town.net.xml"/>'
        '<route-files value="cars.rou.xml,people.xml"/></input></configuration>'
    )
    return folder / "town.sumocfg"


@pytest.mark.long
@pytest.mark.parametrize(("step_s", "duration_s"), [(1.0, 60.0), (0.25, 25.0)])
def test_a_new_network_with_default_names_runs_to_its_end(
    town: Path, tmp_path: Path, step_s: float, duration_s: float
) -> None:
    request = RunRequest(
        str(town), "aeb", ego_share=0.5, duration_s=duration_s, step_s=step_s, out=tmp_path / "out"
    )
    result = run(request)
    assert result.valid, result.invalid_reason
    assert result.description["n_steps"] == round(duration_s / step_s)
    assert not libsumo.isLoaded()
