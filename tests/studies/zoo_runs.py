"""Results of a zoo, made up."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from studies.zoo.driving import RESULTS, STATE

RUN = {
    "valid": 1,
    "invalid_reason": "",
    "ego_count": 4,
    "n_entered": 50,
    "n_contacts_standing": 0,
    "n_vehicle_overlaps_ego_closed": 0,
    "n_close_passes": 0,
    "n_interventions": 0,
    "n_interventions_tight_bend": 0,
    "n_interventions_off_lane": 0,
    "n_stopped_on_crossing": 0,
    "n_stopped_on_crossing_foreseeable": 0,
    "deadlock": 0,
    "n_egos_given_up": 0,
    "ego_time_loss_s": 40.0,
}
ENCOUNTER = {
    "ego_id": "7",
    "ped_id": "7",
    "collision": 1,
    "t_collision_s": 12.5,
    "impact_speed_kmh": 9.25,
    "preventable_r157": 1,
}


def ended(folder: Path, code: int = 0, said: str = "") -> None:
    """Say how the batch of a network ended."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / STATE).write_text(json.dumps({"code": code, "said": said}))


def run(
    folder: Path,
    controller: str,
    seed: int,
    encounters: Sequence[Mapping[str, object]] = (),
    **values: object,
) -> None:
    """Write a finished run."""
    place = folder / RESULTS / "runs" / f"town-{controller}-{seed}"
    place.mkdir(parents=True)
    (place / "job.json").write_text(json.dumps({"controller": controller, "seed": seed}))
    _write(place / "runs.csv", [{**RUN, **values}])
    _write(place / "encounters.csv", [{**ENCOUNTER, "collision": 0}, *encounters])


def failure(folder: Path, controller: str, seed: int, reason: str) -> None:
    """Write a failed run that left nothing else."""
    place = folder / RESULTS / "failed" / f"town-{controller}-{seed}"
    place.mkdir(parents=True)
    content = {"controller": controller, "seed": seed, "reason": reason}
    (place / "failure.json").write_text(json.dumps(content))


def _write(path: Path, rows: Sequence[Mapping[str, object]]) -> None:
    heads = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, heads)
        writer.writeheader()
        writer.writerows(rows)
