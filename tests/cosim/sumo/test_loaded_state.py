"""Vehicles and persons of a state that SUMO saved: they are there from the first step on and never depart."""

from pathlib import Path

import pytest
from libsumo import close, simulationStep, start

from cosim.errors import InputError
from sumo_scenarios.model import Egos

from .conftest import OpenWorld, drive

pytestmark = pytest.mark.sumo

DEMAND = (
    '<flow id="f" type="car" begin="0" end="9" period="2" from="am" to="jb" departSpeed="8" departPos="30"/>'
    '<personFlow id="p" begin="0" end="9" period="3" departPos="130"><walk from="am" to="ma"/></personFlow>'
)


@pytest.fixture
def state(tmp_path: Path, town_file: Path) -> Path:
    """Everybody after 12 s."""
    routes, path = tmp_path / "before.rou.xml", tmp_path / "state.xml"
    routes.write_text(f'<routes><vType id="car" vClass="passenger"/>{DEMAND}</routes>')
    options = ["--lateral-resolution", "0.4", "--step-length", "0.1", "--no-step-log", "true"]
    saved = [
        "--save-state.times",
        "12",
        "--save-state.files",
        str(path),
        "--save-state.transportables",
        "true",
    ]
    start(["sumo", "-n", str(town_file), "-r", str(routes), *options, *saved])
    try:
        for _ in range(125):
            simulationStep()
    finally:
        close()
    return path


def test_they_may_be_egos_and_everybody_is_recorded(open_world: OpenWorld, state: Path) -> None:
    def opened(egos: Egos, **keys: object) -> set[str]:
        snapshots = drive(open_world("", egos, begin_s=12.0, duration_s=3.0, state=state, **keys))
        traffic = snapshots[-1].traffic
        if traffic is not None:
            return {*traffic.vehicles.names, *traffic.persons.names}
        return {ego.name for snapshot in snapshots for ego in snapshot.egos}

    assert opened(Egos(vehicles=("f.1",))) == {"f.1"}
    assert len(opened(Egos(share=1.0))) >= 4
    seen = opened(Egos(), everybody=True)
    assert any(name.startswith("f.") for name in seen)
    assert any(name.startswith("p.") for name in seen)


def test_another_begin_than_the_states_is_refused(open_world: OpenWorld, state: Path) -> None:
    with pytest.raises(InputError, match=r"load-state is of 12 s; expected that time as begin, got 0 s"):
        open_world("", Egos(share=1.0), state=state)
