"""A configuration as a run uses it: the same input, and nothing written beside the user's files.

SUMO writes what a configuration or an additional file tells it to, relative to that file: into the user's
folder, over the results of the user's own runs. And it refuses options of a window that it was built without.
So a run starts from a copy of the configuration that lacks both, and of those additional files that name
outputs.
"""

from __future__ import annotations

import gzip
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import IO, cast
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

from sumo_scenarios.sumocfg import SumoConfiguration
from sumo_scenarios.xml_files import check_xml

NOWHERE = "/dev/null"

_WINDOW = frozenset(
    {"osg-view", "game", "game.mode", "demo", "start", "quit-on-end", "breakpoints", "tracker-interval"}
    | {"gui-testing", "gui-testing-debug", "gui-testing.setting-output", "registry-viewport"}
)
"""Options for somebody who looks on; not every SUMO knows them."""
_WRITTEN = re.compile(
    r".*-output(\..*)?|output-(prefix|suffix)|output\..*|netstate-dump(\..*)?|save-state\..*|"
    r"(.*-)?log(\..*)?|device\.rerouting\.output|device\.taxi\..*\.output|device\.(ssm|toc)\.file|"
    r"save-configuration|save-template|save-schema|save-commented"
)
_KEPT = frozenset({"no-step-log"})
_FILES = re.compile(r".*files?(-.*)?|.*\.input-file|load-state|.*-path")
DETECTORS = frozenset(
    {"inductionLoop", "e1Detector", "instantInductionLoop", "laneAreaDetector", "e2Detector"}
    | {"entryExitDetector", "e3Detector", "edgeData", "laneData", "routeProbe", "vTypeProbe"}
)
"""Elements of additional files whose ``file`` is written."""
_MENTIONS = re.compile(rb"\s(file|output|dest)\s*=|device\.(ssm|toc)\.file|<include\s")
_INCLUDE = re.compile(rb"<include\s[^>]*href\s*=\s*[\"']([^\"']*)[\"']")


def private_configuration(configuration: SumoConfiguration, work_dir: Path) -> Path:
    """Write a copy of a configuration for one run, with the copies that it needs, and return it.

    Parameters
    ----------
    configuration : the user's
    work_dir : where copies go
    """
    folder = configuration.path.parent
    options: dict[str, str] = {}
    for key, value in kept_options(configuration.options).items():
        options[key] = _absolute(value, folder) if _FILES.fullmatch(key) else value
    for key, files in (
        ("route-files", configuration.route_files),
        ("additional-files", configuration.additional_files),
    ):
        if files:
            options[key] = ",".join(str(_silent(path.resolve(), work_dir)) for path in files)
    work_dir.mkdir(parents=True, exist_ok=True)
    target = work_dir / "run.sumocfg"
    lines = [f"    <{key} value={quoteattr(value)}/>" for key, value in options.items()]
    target.write_text("<configuration>\n" + "\n".join(lines) + "\n</configuration>\n", encoding="utf-8")
    return target


def kept_options(options: Mapping[str, str]) -> dict[str, str]:
    """Return the options without those that write files or belong to a window alone.

    >>> kept_options({"end": "60", "tripinfo-output": "t.xml", "osg-view": "true", "log": "log"})
    {'end': '60'}
    """
    return {
        key: value
        for key, value in options.items()
        if key in _KEPT or not (key in _WINDOW or _WRITTEN.fullmatch(key))
    }


def included_files(path: Path) -> list[Path]:
    """Return the files that a file includes, and those that they include.

    Raises
    ------
    ScenarioError
        If one is missing or not well-formed.
    """
    with _opened(path) as file:
        names = [name.decode() for name in _INCLUDE.findall(file.read())]
    found = []
    for name in names:
        included = path.parent / name
        check_xml(included, asked_by=path)
        found += [included, *included_files(included)]
    return found


def _absolute(names: str, folder: Path) -> str:
    """Return file names, separated by commas, as they are seen from anywhere."""
    whole = (name.strip() for name in os.path.expandvars(names).split(","))
    return ",".join(str((folder / name).resolve()) for name in whole if name)


def _silent(path: Path, work_dir: Path) -> Path:
    """Return a file that names no output: the given one, or a copy of it."""
    with _opened(path) as file:
        if not _MENTIONS.search(file.read()):
            return path
    with _opened(path) as file:
        root = ElementTree.parse(file).getroot()
    changed = _silence(root.iter(), path.parent)
    for include in root.iter("include"):
        included = (path.parent / include.get("href", "")).resolve()
        silent = _silent(included, work_dir)
        include.set("href", str(silent))
        changed = changed or silent != included
    if not changed:
        return path
    number = sum(1 for _ in work_dir.glob("silent-*"))
    target = work_dir / f"silent-{number}-{path.name.removesuffix('.gz')}"
    ElementTree.ElementTree(root).write(target, encoding="utf-8", xml_declaration=True)
    return target


def _silence(elements: Iterable[ElementTree.Element], folder: Path) -> bool:
    """Send every output nowhere, make names of input files absolute, and return whether there was output."""
    found = False
    for element in elements:
        written = {
            "file": element.tag in DETECTORS,
            "output": element.tag == "calibrator",
            "dest": element.tag == "timedEvent",
            "value": element.get("key", "") in ("device.ssm.file", "device.toc.file"),
        }
        for attribute, is_output in written.items():
            name = element.get(attribute)
            if name is None:
                continue
            if is_output:
                element.set(attribute, NOWHERE)
                found = True
            elif attribute == "file" and (folder / name).exists():
                element.set(attribute, str((folder / name).resolve()))
    return found


def _opened(path: Path) -> IO[bytes]:
    with path.open("rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
    return cast(IO[bytes], gzip.open(path, "rb")) if packed else path.open("rb")
