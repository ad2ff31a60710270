"""Drives controllers in place of each real car that came near a pedestrian or bicycle.

``python -m studies.validation.in_place FOLDER [NAME=VALUE ...]`` makes the missing drives and prints the
tables. It may be interrupted and repeated. ``controllers=vo_mpc,aeb`` and ``cars=5`` reduce the work.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd

from analysis.encounters.severity_scale import CONFLICTS
from analysis.files import read_csv, read_json, write_csv
from analysis.markdown import table_of
from analysis.trajectories import dlr
from analysis.trajectories.table import PEDESTRIAN
from cosim.errors import InputError, SimulationError
from cosim.tracks.judging import OnNetwork, TracksRequest, read_on_network
from cosim.validation.demand import LEAST_WAY_M
from cosim.validation.site import Site, read_site
from cosim.validation.stand_in import (
    AFTER_S,
    BEFORE_S,
    OFF_M,
    OWN,
    StandInRequest,
    centres,
    drive,
    off_recorded,
)
from studies.validation.signals import (
    LEAST_AGREEMENT,
    LEAST_PASSAGES,
    Inferred,
    infer,
    movement_of,
    read_states,
    write_program,
)

SCENARIO, CONTROLLERS = "braunschweig", ("vo_mpc", "aeb", "sumo")
NEAR_M = 10.0
"""Distance between the centres of two bodies within which they are near [m]."""
LONGEST_S = 600.0
"""Longest wall-clock time of one drive [s]."""
DRIVEN = "driven.csv"
"""File with the numbers of one drive, which is written last."""
HEADS = (
    *("people", "people_reacting", "contacts", "contacts_reacting", "conflicts", "conflicts_reacting"),
    *("bicycles", "bicycles_reacting", "bicycles_struck", "overlaps", "overlaps_reacting"),
    *("nearest_m", "off_m"),
)


def near_cars(frame: pd.DataFrame) -> list[str]:
    """Return the cars that moved and came near a pedestrian or bicycle, sorted."""
    near: set[str] = set()
    others = dict(tuple(frame[frame["kind"].isin([PEDESTRIAN, "bicycle"])].groupby("step")))
    for step, cars in frame[frame["kind"] == "car"].groupby("step"):
        if step not in others:
            continue
        there = others[step][["x_m", "y_m"]].to_numpy()
        away = np.hypot(*(cars[["x_m", "y_m"]].to_numpy()[:, None] - there).T).min(axis=0)
        near |= {str(name) for name in cars["id"][away <= NEAR_M]}
    ways = frame[frame["id"].isin(near)].groupby("id")[["x_m", "y_m"]].agg(np.ptp)
    return sorted(ways.index[np.hypot(ways["x_m"], ways["y_m"]) >= LEAST_WAY_M])


def left_out(car: str, found: OnNetwork, inferred: Sequence[Inferred]) -> str:
    """Return why no ego replaces a car; empty if one does."""
    made = movement_of(found.placed.frame[found.placed.frame["id"] == car], found)
    known = {one.movement for one in inferred if one.known}
    return "" if made is None or made[1] in known else "the signal of its movement is not known"


def drive_all(folder: Path, controllers: Sequence[str], most: int) -> str:
    """Make the missing drives, and return the tables."""
    with TemporaryDirectory() as work:
        site = read_site(SCENARIO, Path(work))
        found = read_on_network(TracksRequest(dlr.PACKAGED, site.net_file))
        states = read_states(dlr.packaged())
        inferred = infer(found, states)
        near = near_cars(found.placed.frame)
        cars = near[:most]
        reasons: dict[str, int] = {}
        taken = []
        for car in cars:
            reason = left_out(car, found, inferred)
            if reason:
                reasons[reason] = reasons.get(reason, 0) + 1
                continue
            taken.append(car)
            own = found.placed.frame[found.placed.frame["id"] == car]["time_s"]
            begin = max(0.0, float(np.floor(own.min() - BEFORE_S)))
            lights = write_program(
                *(Path(work) / f"{car}.add.xml", found, inferred, states),
                *((begin, float(own.max()) + AFTER_S), site.begin_s),
            )
            lit = replace(site, additional_files=(*site.additional_files, lights))
            for controller in controllers:
                _drive(folder / controller / car.replace("/", "_"), car, controller, lit, found, begin)
    which = f"{len(near)} cars" if len(cars) == len(near) else f"The first {len(cars)} of {len(near)} cars"
    return _page(folder, controllers, which, taken, reasons, inferred)


def _drive(out: Path, car: str, controller: str, site: Site, found: OnNetwork, begin_s: float) -> None:
    if (out / DRIVEN).is_file():
        return
    if out.is_dir():
        shutil.rmtree(out)
    print(f"{controller} in the place of {car}", file=sys.stderr, flush=True)
    # In a process of its own, in case SUMO crashes; forked, so that the tracks need not be read again.
    process = get_context("fork").Process(target=_driven, args=(out, car, controller, site, found, begin_s))
    process.start()
    process.join(LONGEST_S)
    if process.is_alive():
        process.kill()
        process.join()
    if not (out / DRIVEN).is_file():
        out.mkdir(parents=True, exist_ok=True)
        write_csv(out / DRIVEN, ["failed"], [[f"the process ended with {process.exitcode}"]])


def _driven(out: Path, car: str, controller: str, site: Site, found: OnNetwork, begin_s: float) -> None:
    try:
        done = drive(StandInRequest(SCENARIO, dlr.PACKAGED, car, controller, out=out), site, found)
    except (InputError, SimulationError) as error:
        out.mkdir(parents=True, exist_ok=True)
        write_csv(out / DRIVEN, ["failed"], [[str(error)]])
        return
    row = judged(done.folder, found, begin_s, [(one.could_react, one.severity) for one in done.met])
    invalid = read_json(out / "run" / "run.json")["invalid_reason"] or ""
    write_csv(out / DRIVEN, ["failed", *HEADS], [[invalid, *(f"{row[name]:.10g}" for name in HEADS)]])


def judged(
    folder: Path, found: OnNetwork, begin_s: float, met: Sequence[tuple[bool, str]]
) -> dict[str, float]:
    """Return the measures of one drive.

    Parameters
    ----------
    folder : folder of the drive
    found : recorded tracks on the network
    begin_s : time in the recording at which the drive begins [s]
    met : for each encounter with a pedestrian, whether they could react, and its severity
    """
    egos = pd.read_parquet(folder / "run" / "egos.parquet")
    off = off_recorded(folder / "scenario", egos)
    so_far = np.maximum.accumulate(off.to_numpy())
    times = off.index.to_numpy()
    shift = float(times[0] - egos["time_s"].iloc[0])
    centre = centres(egos)
    bicycles, reacting, nearest = 0, 0, np.inf
    frame = found.placed.frame
    for _, track in frame[frame["kind"] == "bicycle"].groupby("id"):
        time = track["time_s"].to_numpy() - begin_s
        inside = (times >= time[0]) & (times <= time[-1])
        if not inside.any():
            continue
        at = np.column_stack([np.interp(times[inside], time, track[name]) for name in ("x_m", "y_m")])
        away = np.hypot(*(centre[inside] - at).T)
        nearest = min(nearest, float(away.min()))
        if away.min() <= NEAR_M:
            bicycles += 1
            reacting += bool(so_far[inside][int(away.argmin())] <= OFF_M)
    kinds = dict(zip(frame["id"], frame["kind"], strict=True))
    overlaps = [
        (so_far[np.searchsorted(times, float(one["t_start_s"]) + shift - 1e-6)] <= OFF_M, one["vehicle_id"])
        for one in read_csv(folder / "run" / "vehicle_overlaps.csv")
        if one["closed_by"] == "ego"
    ]
    return {
        "people": len(met),
        "people_reacting": sum(could for could, _ in met),
        "contacts": sum(severity == "collision" for _, severity in met),
        "contacts_reacting": sum(could and severity == "collision" for could, severity in met),
        "conflicts": sum(severity in CONFLICTS for _, severity in met),
        "conflicts_reacting": sum(could and severity in CONFLICTS for could, severity in met),
        "bicycles": bicycles,
        "bicycles_reacting": reacting,
        "bicycles_struck": sum(kinds.get(name) == "bicycle" for _, name in overlaps),
        "overlaps": len(overlaps),
        "overlaps_reacting": sum(bool(could) for could, _ in overlaps),
        "nearest_m": nearest,
        "off_m": float(so_far[times <= recorded_end(folder)][-1]),
    }


def recorded_end(folder: Path) -> float:
    """Return when the real car of a drive left the recording, in scenario time [s]."""
    with (folder / "scenario" / OWN).open(encoding="utf-8") as file:
        return float(file.read().split()[-1].split(",")[0])


def _page(
    folder: Path,
    controllers: Sequence[str],
    which: str,
    taken: Sequence[str],
    reasons: dict[str, int],
    inferred: Sequence[Inferred],
) -> str:
    rows: list[dict[str, Any]] = []
    for controller in controllers:
        files = [folder / controller / car.replace("/", "_") / DRIVEN for car in taken]
        drives = [read_csv(file)[0] for file in files if file.is_file()]
        whole = [one for one in drives if not one["failed"]]

        def both(name: str, some: Sequence[dict[str, str]] = whole) -> str:
            reacting = sum(int(one[f"{name}_reacting"]) for one in some)
            return f"{reacting} + {sum(int(one[name]) for one in some) - reacting}"

        rows.append(
            {
                "driver": f"`{controller}`",
                "drives": len(whole),
                "failed": len(drives) - len(whole),
                "encounters with pedestrians": both("people"),
                "conflicts": both("conflicts"),
                "contacts": both("contacts"),
                "bicycles within 10 m": both("bicycles"),
                "bicycles struck": sum(int(one["bicycles_struck"]) for one in whole),
                "overlaps that it closed": both("overlaps"),
                "drives within 2 m of the real car": sum(float(one["off_m"]) <= OFF_M for one in whole),
            }
        )
    why = "; ".join(f"{count}: {reason}" for reason, count in sorted(reasons.items())) or "none"
    return (
        f"{which} that moved and came within {NEAR_M:g} m of a pedestrian or bicycle, between centres, "
        f"replaced by an ego. Left out: {why}. Of *a + b*, *a* counts those who "
        f"could react, because the ego was within {OFF_M:g} m of where the real car had been until their "
        "encounter ended; *b* counts the others, who met the ego in another place and so say little.\n\n"
        f"{table_of(rows)}\n\nSignals, inferred by when vehicles passed the stop line and stood before it; "
        f"a movement with less than {100 * LEAST_AGREEMENT:g} % "
        f"agreement (the mean of the two shares) or fewer than {LEAST_PASSAGES} passages has none:\n\n"
        + table_of(
            [
                {
                    "approach": one.movement[0],
                    "direction": one.movement[1],
                    "passages": one.passages,
                    "not on red [%]": f"{100 * one.on_green:.1f}",
                    "instants of standing": one.standing,
                    "not on green [%]": f"{100 * one.not_on_green:.1f}" if one.standing else "–",
                    "signal": one.signal if one.known else "–",
                }
                for one in inferred
            ]
        )
    )


def main(words: Sequence[str]) -> None:
    """Read the command line, make the drives, and print the tables."""
    said = dict(word.split("=", 1) for word in words[1:])
    controllers = tuple(said.get("controllers", ",".join(CONTROLLERS)).split(","))
    print(drive_all(Path(words[0]), controllers, int(said.get("cars", 10**6))))


if __name__ == "__main__":
    main(sys.argv[1:])
