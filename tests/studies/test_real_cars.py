"""Signals inferred from when cars stop and go, and why samples of tracks miss the network."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest

from cosim.tracks.judging import OnNetwork, TracksRequest, read_on_network
from studies.validation.in_place import near_cars
from studies.validation.misses import CHANGING, INSIDE, cars, pedestrians, tables
from studies.validation.signals import infer, movement_of, write_program
from tests.analysis.trajectories import streets
from tests.cosim.tracks import networks

RED, GREEN, YELLOW = 3, 5, 7
CARS, EVERY_S, STOOD_S = 6, 40.0, 10.0


def stopping(number: int) -> pd.DataFrame:
    """Return a car that stands with its front 2 m before the stop line for 10 s, and drives on."""
    begin, name = EVERY_S * number, f"car {number}"
    there = begin + 7.0
    return pd.concat(
        [
            streets.track(name, "car", (20.0, -1.6), (10.0, 0.0), begin, 6.9),
            streets.track(name, "car", (90.0, -1.6), (0.0, 0.0), there, STOOD_S - 0.1),
            streets.track(name, "car", (90.0, -1.6), (10.0, 0.0), there + STOOD_S, 8.0),
        ]
    )


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> OnNetwork:
    """Return cars at a signal, on the network."""
    folder = tmp_path_factory.mktemp("signals")
    network = networks.street(folder, "--tls.set", "middle")
    walk = [streets.walker("walker", 10.0)]
    streets.write(folder / "tracks.csv", [*(stopping(number) for number in range(CARS)), *walk])
    return read_on_network(TracksRequest(str(folder / "tracks.csv"), network))


@pytest.fixture(scope="module")
def states() -> pd.DataFrame:
    """Return the states of the cars' signal, of another one, and of one that never shows yellow."""
    seconds = np.arange(int(CARS * EVERY_S))
    since = seconds % EVERY_S
    own = np.where((since >= 17.0) & (since < 25.0), GREEN, np.where(since < 27.0, YELLOW, RED))
    own = np.where(since < 17.0, RED, own)
    other = np.where(own == RED, GREEN, np.where(own == GREEN, RED, YELLOW))
    never_yellow = np.where(own == RED, RED, GREEN)
    return pd.DataFrame({1: never_yellow, 2: other, 3: own}, index=seconds.astype(float))


@pytest.mark.sumo
def test_the_signal_of_a_movement_is_the_one_that_cars_obey(found: OnNetwork, states: pd.DataFrame) -> None:
    (one,) = infer(found, states)
    assert (one.movement, one.passages, one.signal) == (("e1", "s"), CARS, 3)
    assert one.standing > 50
    assert (one.on_green, one.not_on_green, one.known) == (1.0, 1.0, True)
    upside_down = states[[2]].rename(columns={2: 9})
    (wrong,) = infer(found, upside_down)
    assert not wrong.known


@pytest.mark.sumo
def test_the_recorded_phases_become_a_program_of_the_traffic_light(
    found: OnNetwork, states: pd.DataFrame, tmp_path: Path
) -> None:
    inferred = infer(found, states)
    write_program(tmp_path / "p.add.xml", found, inferred, states, (40.0, 79.0), 100.0)
    (logic,) = ElementTree.parse(tmp_path / "p.add.xml").getroot()
    assert (logic.get("programID"), logic.get("offset")) == ("recorded", "100")
    (group,) = (group for group in found.network.connections.values() if group[0].source.startswith("e1_1"))
    link = group[0].signal_index
    shown = [
        (float(one.get("duration", "")), one.get("state", "")[link].lower()) for one in logic.iter("phase")
    ]
    assert shown == [(17.0, "r"), (8.0, "g"), (2.0, "y"), (13.0, "r")]
    others = {letter for one in logic.iter("phase") for letter in set(one.get("state", "")) - set("rgGy")}
    assert others == {"o"}, "nobody is known to obey the other links"


@pytest.mark.sumo
def test_only_the_car_that_was_near_somebody_is_replaced(found: OnNetwork) -> None:
    frame = found.placed.frame
    assert near_cars(frame) == ["car 0"]
    made = movement_of(frame[frame["id"] == "car 0"], found)
    assert made is not None
    assert made[1] == ("e1", "s")


@pytest.mark.sumo
def test_samples_that_miss_the_network_have_a_cause(tmp_path: Path) -> None:
    network = networks.street(
        tmp_path, edges=networks.EDGES.replace('numLanes="1"', 'numLanes="1" width="4.4"')
    )
    tracks = [
        *(streets.track(f"on {n}", "car", (20.0, -2.2), (10.0, 0.0), 20.0 * n, 6.0) for n in range(2)),
        streets.track("beside it", "car", (20.0, -3.5), (10.0, 0.0), 60.0, 6.0),
        streets.track("beside the crossing", "pedestrian", (96.0, -4.0), (0.0, 1.4), 0.0, 5.0),
    ]
    streets.write(tmp_path / "tracks.csv", tracks)
    found = read_on_network(TracksRequest(str(tmp_path / "tracks.csv"), network))
    driving = cars(found)
    missed = driving[driving["missed"]]
    assert set(missed["cause"]) == {INSIDE}
    assert CHANGING not in set(driving["cause"])
    assert len(missed) == pytest.approx(len(driving) / 3.0, abs=2)
    assert driving["inside"].all()
    walking = pedestrians(found)
    assert "beside a crossing" in set(walking["cause"][walking["missed"]])
    assert f"| {INSIDE} | {len(missed)} | 33.3 |" in tables(found)
