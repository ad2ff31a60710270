"""Export of a recorded run as SUMO's floating car data (FCD), which many tools read."""

from __future__ import annotations

import math
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from xml.sax.saxutils import quoteattr

from analysis.errors import AnalysisError
from analysis.files import completing
from cosim.errors import InputError
from cosim.exchange.recorded import columns
from cosim.recording import folders

FILE = "fcd.xml"


def write_fcd(folder: Path, out: Path) -> Path:
    """Write the egos and everybody near them, and return the file.

    Parameters
    ----------
    folder
        Folder of the run.
    out
        New or empty folder.

    Notes
    -----
    As in SUMO: positions are those of the front bumper, angles in degrees clockwise from north.

    Raises
    ------
    InputError
        If the run cannot be read, or the file cannot be written.
    """
    folders.check(out)
    try:
        rows = sorted([*_egos(folder), *_neighbours(folder)], key=lambda row: (row[0], row[1], row[2]))
        out.mkdir(parents=True, exist_ok=True)
        with completing(out / FILE) as part, part.open("w", encoding="utf-8", newline="\n") as file:
            file.write('<?xml version="1.0" encoding="UTF-8"?>\n<fcd-export>\n')
            for time, group in groupby(rows, key=itemgetter(0)):
                file.write(f'    <timestep time="{time:.2f}">\n')
                file.writelines(f"        <{kind} {text}/>\n" for _, kind, _, text in group)
                file.write("    </timestep>\n")
            file.write("</fcd-export>\n")
    except AnalysisError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"cannot write to {out}: {error.strerror or error}") from error
    return out / FILE


Row = tuple[float, str, str, str]


def _egos(folder: Path) -> list[Row]:
    names = ("time_s", "ego_id", "front_x_m", "front_y_m", "heading_rad", "speed_mps", "lane")
    found = []
    for time, name, x, y, heading, speed, lane in zip(*columns(folder, "egos.parquet", names), strict=True):
        found.append((time, "vehicle", name, _text(name, x, y, heading, speed, "ego", lane=lane or "")))
    return found


def _neighbours(folder: Path) -> list[Row]:
    names = ("time_s", "object_id", "object_kind", "object_type", "x_m", "y_m", "heading_rad")
    further = ("x_speed_mps", "y_speed_mps", "edge_or_lane")
    found = []
    rows = zip(*columns(folder, "neighbours.parquet", names + further), strict=True)
    for time, name, kind, what, x, y, heading, vx, vy, place in rows:
        person = kind == "pedestrian"
        where = {"edge" if person else "lane": place or ""}
        text = _text(name, x, y, heading or 0.0, math.hypot(vx, vy), what or "", **where)
        found.append((time, "person" if person else "vehicle", name, text))
    return found


def _text(name: str, x: float, y: float, heading: float, speed: float, kind: str, **where: str) -> str:
    angle = (90.0 - math.degrees(heading)) % 360.0
    place = " ".join(f"{key}={quoteattr(value)}" for key, value in where.items())
    return (
        f'id={quoteattr(name)} x="{x:.3f}" y="{y:.3f}" angle="{angle:.2f}" type={quoteattr(kind)} '
        f'speed="{speed:.3f}" {place}'
    )
