"""Whether a very long run ends, and in how much memory: twelve simulated hours on the Braunschweig junction.

The network, its signals and one measured hour of traffic are those that SUMO ships (``fokr_bs_demo``). The
hour's vehicles and cyclists come again every hour. As shipped, each of the cyclists comes again every 25 s
and each of the pedestrians every 15 s, which jams the junction within the hour even without egos; here one of
four pedestrians comes.

The run says every simulated hour, on the standard error stream, how far it has come.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import gzip
import json
import sys
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

from measuring import results
from measuring.bars import Bar, show
from measuring.command import options
from measuring.resident import HOUR_S, Looks, in_process, settled, slope

from analysis.results.analyse import analyse_run
from cosim.running.request import RunRequest
from cosim.running.simulation import run
from sumo_scenarios.sumo_installation import packaged_file

DEMO = "tools/game/fokr_bs_demo"
VEHICLES, BICYCLES, PEOPLE = "15_16_veh.trips.xml.gz", "15_16_bicycle.trips.xml", "15_16_ped.trips.xml"
BEGIN_S = 15 * HOUR_S
PERIODS_S = {BICYCLES: HOUR_S, PEOPLE: 60.0}
"""Between two of a flow; 25 and 15 as shipped."""
HOURS, EGO_SHARE, STEP_S, SEED, CONTROLLER = 12.0, 0.2, 1.0, 1, "vo_mpc"
SETTLED_S = 2.0 * HOUR_S
MOST_MB_PER_HOUR = 20.0


def long_demand(folder: Path) -> Path:
    """Write a configuration whose demand lasts all the hours, and return it."""
    folder.mkdir(parents=True, exist_ok=True)
    end = BEGIN_S + HOURS * HOUR_S
    trips = ElementTree.fromstring(gzip.decompress(packaged_file(f"{DEMO}/{VEHICLES}").read_bytes()))
    repeated = ElementTree.Element("routes")
    for hour in range(int(HOURS)):
        for trip in trips.iter("trip"):
            depart = float(trip.attrib["depart"]) + hour * HOUR_S
            again = dict(trip.attrib, id=f"{trip.attrib['id']}.{hour}", depart=f"{depart:.3f}")
            ElementTree.SubElement(repeated, "trip", again)
    ElementTree.ElementTree(repeated).write(folder / "vehicles.xml")
    for name, period in PERIODS_S.items():
        flows = ElementTree.parse(packaged_file(f"{DEMO}/{name}"))
        for flow in [*flows.iter("flow"), *flows.iter("personFlow")]:
            flow.attrib |= {"period": f"{period:g}", "end": f"{end:g}"}
        flows.write(folder / name)
    shipped = [packaged_file(f"{DEMO}/{name}") for name in ("vtypes_default.add.xml", "signalPlan.add.xml")]
    options = {
        "net-file": packaged_file(f"{DEMO}/fokr_bs.net.xml.gz"),
        "route-files": ",".join(("vehicles.xml", BICYCLES, PEOPLE)),
        "additional-files": ",".join(map(str, shipped)),
        "begin": f"{BEGIN_S:g}",
        "end": f"{end:g}",
        "step-length": f"{STEP_S:g}",
        "pedestrian.striping.stripe-width": "0.55",
    }
    configuration = ElementTree.Element("configuration")
    for name, value in options.items():
        ElementTree.SubElement(configuration, name, value=str(value))
    file = folder / "braunschweig_long.sumocfg"
    ElementTree.ElementTree(configuration).write(file)
    return file


class Hours:
    """Says every simulated hour how far a run has come; a run that is stopped has told something."""

    def __init__(self) -> None:
        self._told = 0
        self._since = time.perf_counter()

    def tell(self, elapsed_s: float, looks: Looks) -> None:
        """Say it, if an hour is over since the last time."""
        if elapsed_s < (self._told + 1) * HOUR_S - 1e-6:
            return
        now, self._told = time.perf_counter(), self._told + 1
        step_ms = 1e3 * (now - self._since) / (HOUR_S / STEP_S)
        resident = looks.found["resident_mb"][-1]
        print(f"{self._told} h: {step_ms:.0f} ms a step, {resident:.0f} MB", file=sys.stderr, flush=True)
        self._since = now


def simulated(folder: Path, duration_s: float) -> dict[str, Any]:
    """Simulate and record into ``folder / "run"``; return resident memory over simulated time."""
    looks, hours = Looks(), Hours()

    def progress(now: float, end: float | None) -> None:
        looks.look(now - BEGIN_S)
        hours.tell(now - BEGIN_S, looks)

    file = long_demand(folder)
    request = RunRequest(
        str(file), CONTROLLER, SEED, duration_s=duration_s, ego_share=EGO_SHARE, out=folder / "run"
    )
    result = run(request, progress)
    return {
        **looks.found,
        "invalid_reason": result.description["invalid_reason"],
        "egos_given_up": len(result.description["egos_given_up"]),
        "recorded_mb": sum(part.stat().st_size for part in result.folder.iterdir()) / 1e6,
    }


def judged(folder: Path) -> dict[str, Any]:
    """Judge what was recorded; return the most memory, the processor time, and what came of the run."""
    began = process_time()
    row = analyse_run(folder / "run").run
    wanted = (
        "ego_count",
        "n_encounters",
        "n_entered",
        "n_collisions",
        "n_collisions_preventable",
        "deadlock",
    )
    return {
        "analysed_mb": Looks.most_mb(),
        "judging_cpu_s": process_time() - began,
        **{name: row.get(name) for name in wanted},
    }


def measured(place: Path, duration_s: float) -> dict[str, Any]:
    """Simulate and judge, each in a process of its own, so that each has a peak of its own."""
    began = time.perf_counter()
    seen = in_process(__file__, "--simulate", str(place), f"{duration_s}")
    simulated_s = time.perf_counter() - began
    return {**seen, "took_s": simulated_s, **in_process(__file__, "--judge", str(place))}


def main() -> None:
    """Measure, print and publish."""
    if sys.argv[1:2] == ["--simulate"]:
        print(json.dumps(simulated(Path(sys.argv[2]), float(sys.argv[3]))))
        return
    if sys.argv[1:2] == ["--judge"]:
        print(json.dumps(judged(Path(sys.argv[2]))))
        return
    given = options(__doc__)
    duration_s = 120.0 if given.quick else HOURS * HOUR_S
    settled_s = 60.0 if given.quick else SETTLED_S
    with TemporaryDirectory() as place:
        seen = measured(Path(place), duration_s)
    times, sizes = settled(seen, settled_s)
    found: dict[str, Any] = {
        "controller": CONTROLLER,
        "ego_share": EGO_SHARE,
        "step_s": STEP_S,
        "simulated_s": duration_s,
        "settled_s": settled_s,
        "mb_per_hour": slope(times, sizes),
        **seen,
    }
    print(
        f"{duration_s / HOUR_S:g} simulated hours in {found['took_s'] / 60.0:.0f} min: "
        f"{seen['ego_count']} egos, {seen['n_entered']} entered encounters, {seen['n_collisions']} contacts; "
        f"{seen['recorded_mb']:.0f} MB recorded; invalid: {seen['invalid_reason'] or 'no'}"
    )
    bars = [
        Bar(
            what=f"growth of resident memory over {duration_s / HOUR_S:g} simulated hours",
            measured=found["mb_per_hour"],
            at_most=MOST_MB_PER_HOUR,
            unit="MB/h",
            note=f"{sizes[0]:.0f} MB at first, {sizes[-1]:.0f} MB at the end, {seen['analysed_mb']:.0f} MB "
            "at most in the process that judges it",
        )
    ]
    show(bars)
    results.publish("endurance", found, bars, given.folder)


if __name__ == "__main__":
    main()
