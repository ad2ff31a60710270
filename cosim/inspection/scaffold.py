"""Makes a scenario folder from an inspected network: copies of its files, and what they lack.

An additional file that names further files is not copied but referred to, as its names are relative. If the
network is mended, every file is a copy that fits the mended network.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

from cosim.errors import InputError
from cosim.inspection.demand import CAR, names_files
from cosim.inspection.inspection import Inspection
from cosim.inspection.mending import mend
from cosim.inspection.walks import Walk, walks_over
from sumo_scenarios.file_names import joined_names
from sumo_scenarios.sumo_options import kept_options

CONFIGURATION = "scenario.sumocfg"
"""Configuration of a scenario that is made from a network alone; an existing one keeps its name."""
STEP_S = 0.1
"""Step length unless the configuration gives a suitable one [s]."""
WARMUP_S = 60.0
LONGEST_S = 900.0
"""Longest duration of the scenario; its configuration may go on for longer [s]."""
PERSONS_PER_HOUR = 150.0
"""Pedestrians at each crossing in each direction [1/h]."""
CARS_PER_HOUR = 300.0
"""Cars on each suggested route [1/h]."""
_INPUTS = ("net-file", "route-files", "additional-files")
_OF_THE_RUN = ("begin", "end", "step-length", "seed", "random", "remote-port", "demo", "start", "quit-on-end")


def write_scaffold(found: Inspection, folder: Path) -> list[str]:
    """Write scenario.toml, a configuration and copies of its input files; return notes for the user.

    A network without crossings is mended, and the copies fit the mended network. Persons and cars are each
    added if the demand has none.

    Raises
    ------
    InputError
        If no ego can be driven over a crossing here, or the folder cannot be written to.
    """
    if found.counts:
        _scaffold(found, found, folder)
        return []
    with tempfile.TemporaryDirectory(prefix="cosim-scaffold-") as work:
        mended, said = mend(found, Path(work), folder)
        _scaffold(mended, found, folder)
    return said


def _scaffold(found: Inspection, given: Inspection, folder: Path) -> None:
    """Write the folder.

    Parameters
    ----------
    found : inspection of the network from which the folder is made
    given : inspection of the user's network: the same one, or that before mending
    """
    net = given.source.net_file
    if not found.routes:
        what = "no car can drive over a crossing" if found.counts else "there is no crossing"
        guessed = "" if found is given else ", nor one that netconvert guesses"
        raise InputError(f"--scaffold: {what} in {net}{guessed}; fix this first")
    if not found.possible and _blocking(found):
        raise InputError(f"--scaffold: {found.verdict}; fix this first")
    walks = walks_over(found.network, found.routes)
    if not walks and found.demand.persons < 0.5:
        raise InputError(f"--scaffold: no sidewalk leads to the crossings in {net}")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _write(found, walks, folder, given)
    except OSError as error:
        raise InputError(f"--scaffold {folder}: {error.strerror}") from error


def _blocking(found: Inspection) -> bool:
    """Return whether something is missing that a scaffold cannot add."""
    added = ("persons", "step length", "sidewalks")
    return any(one.level == "missing" and one.check not in added for one in found.findings)


def _write(found: Inspection, walks: Iterable[Walk], folder: Path, given: Inspection) -> None:
    source = found.source
    own = found is given
    end_s = source.begin_s + LONGEST_S if source.end_s is None else source.end_s
    duration_s = min(end_s - source.begin_s, LONGEST_S)
    warmup_s = min(WARMUP_S, round(0.2 * duration_s, 3))
    configuration = given.source.path.name if given.source.configured else CONFIGURATION
    taken: set[str] = {"scenario.toml", configuration, "persons.rou.xml", "cars.rou.xml"}
    net = _copy(source.net_file, folder, taken)
    additional = [
        os.path.relpath(path, folder) if own and names_files(path) else _copy(path, folder, taken)
        for path in source.additional_files
    ]
    routes = [_copy(path, folder, taken) for path in source.route_files]
    if found.demand.persons < 0.5:
        _text(folder / "persons.rou.xml", _persons(walks, source.begin_s, end_s))
        routes.append("persons.rou.xml")
    if found.demand.vehicles.get(CAR, 0.0) < 0.5:
        _text(folder / "cars.rou.xml", _cars(found, source.begin_s, end_s))
        routes.append("cars.rou.xml")
    _text(folder / configuration, _configuration(found, net, routes, additional))
    _text(
        folder / "scenario.toml",
        _scenario(found, given.source.path.name, configuration, duration_s, warmup_s),
    )


def _copy(path: Path, folder: Path, taken: set[str]) -> str:
    """Copy a file under a name that is not taken, and return the name."""
    name, number = path.name, 1
    while name in taken:
        number += 1
        name = f"{number}-{path.name}"
    taken.add(name)
    shutil.copyfile(path, folder / name)
    return name


def _persons(walks: Iterable[Walk], begin_s: float, end_s: float) -> str:
    rate = PERSONS_PER_HOUR / 3600.0
    lines = ["<!-- In both directions over each crossing that the ego routes pass. -->"]
    for number, walk in enumerate(walks, start=1):
        for name, one in ((f"walk_{number}", walk), (f"walk_{number}_back", walk.back())):
            lines += [
                f'<personFlow id="{name}" begin="{begin_s:g}" end="{end_s:g}" period="exp({rate:.6f})" '
                f'departPos="{one.depart_m:.2f}">',
                f"    <walk from={quoteattr(one.origin)} to={quoteattr(one.destination)} "
                f'arrivalPos="{one.arrival_m:.2f}"/>',
                "</personFlow>",
            ]
    return _routes(lines)


def _cars(found: Inspection, begin_s: float, end_s: float) -> str:
    rate = CARS_PER_HOUR / 3600.0
    lines = ["<!-- Traffic on the ego routes. -->"]
    for number, route in enumerate(found.routes, start=1):
        lines += [
            f'<flow id="cars_{number}" begin="{begin_s:g}" end="{end_s:g}" period="exp({rate:.6f})" '
            'departLane="random" departSpeed="desired">',
            f"    <route edges={quoteattr(' '.join(route.edges))}/>",
            "</flow>",
        ]
    return _routes(lines)


def _routes(lines: Iterable[str]) -> str:
    return "<routes>\n" + "".join(f"    {line}\n" for line in lines) + "</routes>\n"


def _configuration(found: Inspection, net: str, routes: list[str], additional: list[str]) -> str:
    source = found.source
    # The step of a configuration is kept if there is no finding against it.
    kept = "step-length" in source.options and any(
        one.check == "step length" and one.level == "good" for one in found.findings
    )
    step_s = source.step_s if kept else STEP_S
    options = {"net-file": joined_names([net]), "route-files": joined_names(routes)}
    options["additional-files"] = joined_names(additional)
    options |= {"begin": f"{source.begin_s:g}", "step-length": f"{step_s:g}"}
    if source.end_s is not None:
        options["end"] = f"{source.end_s:g}"
    options |= _kept(source.options)
    lines = [f"    <{key} value={quoteattr(value)}/>" for key, value in options.items() if value]
    return "<configuration>\n" + "\n".join(lines) + "\n</configuration>\n"


def _kept(options: Mapping[str, str]) -> dict[str, str]:
    """Return the options that neither name files nor apply to a single run or its window."""
    return {
        key: value
        for key, value in kept_options(options).items()
        if key not in (*_INPUTS, *_OF_THE_RUN) and not any(word in key for word in ("file", "output", "log"))
    }


def _scenario(found: Inspection, origin: str, configuration: str, duration_s: float, warmup_s: float) -> str:
    lines = [
        f"description = {_quoted(f'Made by cosim inspect from {origin}')}",
        f"duration_s = {duration_s:.1f}",
        f"warmup_s = {warmup_s:.1f} # egos enter afterwards",
        f'actuation = "{"move" if found.demand.lane_change_models else "hybrid"}"',
        f"sumocfg = {_quoted(configuration)}",
        "",
        "[egos]",
        f"count = {max(4, len(found.routes))}",
        "headway_s = 30.0",
    ]
    for route in found.routes:
        lines += [
            "",
            f"# {len(route.crossings)} crossings on {route.length_m:.0f} m",
            "[[egos.routes]]",
            f"edges = {_quoted(' '.join(route.edges))}",
        ]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")
