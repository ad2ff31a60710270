"""Outputs named in route files, additional files and networks, and copies of these files without them."""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterable
from pathlib import Path
from typing import IO, cast
from xml.etree import ElementTree

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.xml_files import check_xml

NOWHERE = "/dev/null"

_READ = frozenset({"rerouter", "variableSpeedSign", "calibrator"})
"""Elements whose ``file`` SUMO reads. It writes the ``file`` of all others, such as detectors and probes."""
_PICTURES = ("imgFile", "osgFile")
_DEVICE_OUTPUT = re.compile(r"device\..*\.(file|output)")
_OF_SIGNALS = ("file", "SWARMLOG")
"""Parameters of traffic lights that name output files."""
_MENTIONS = re.compile(
    rb"\s(file|output|dest)\s*=|key\s*=\s*[\"'](file|SWARMLOG|device\.)|<include\s|<!DOCTYPE|&#"
)
_PLAIN = re.compile(rb"(\xef\xbb\xbf)?\s*<(?!\?xml[^>]*encoding\s*=\s*[\"'](?!utf-8[\"']))", re.IGNORECASE)
"""Beginning of a file in UTF-8, whose bytes can be searched as text."""


class SilentCopies:
    """Makes copies of files that name outputs, in which the outputs lead nowhere.

    Parameters
    ----------
    work_dir : folder for the copies
    """

    def __init__(self, work_dir: Path) -> None:
        self._work_dir = work_dir
        self._made = 0
        self.left_out: list[str] = []
        """Outputs that are not written, as shown to the user."""

    def of(self, path: Path) -> Path:
        """Return the file, or a copy without outputs if it or a file that it includes names one."""
        root = _parsed_if_it_mentions(path)
        if root is None:
            return path
        changed = self._silence(root, path)
        for include in root.iter("include"):
            included = (path.parent / include.get("href", "")).resolve()
            silent = self.of(included)
            include.set("href", str(silent))
            changed = changed or silent != included
        if not changed:
            return path
        self._made += 1
        target = self._work_dir / f"silent-{self._made}-{path.name.removesuffix('.gz')}"
        self._work_dir.mkdir(parents=True, exist_ok=True)
        ElementTree.ElementTree(root).write(target, encoding="utf-8", xml_declaration=True)
        return target

    def _silence(self, root: ElementTree.Element, path: Path) -> bool:
        """Redirect outputs to nowhere, make input names absolute, and return whether there was an output."""
        written = [(element, name) for element in root.iter() for name in element.attrib]
        written = [(element, name) for element, name in written if is_output(element.tag, name)]
        keys = [(param, "value") for param in _output_parameters(root)]
        for element, name in (*written, *keys):
            self.left_out.append(f"{element.get('key') or element.tag} in {path.name}")
            element.set(name, NOWHERE)
        for element in root.iter():
            for name in ("file", *_PICTURES):
                file = path.parent / element.get(name, "")
                if element.get(name) and (element, name) not in written and file.exists():
                    element.set(name, str(file.resolve()))
        return bool(written or keys)


def is_output(tag: str, attribute: str) -> bool:
    """Return whether SUMO writes the file that an attribute of an element names.

    >>> is_output("inductionLoop", "file"), is_output("rerouter", "file")
    (True, False)
    """
    if attribute == "file":
        return tag not in _READ
    return (tag, attribute) in (("calibrator", "output"), ("timedEvent", "dest"))


def included_files(path: Path, within: tuple[Path, ...] = ()) -> list[Path]:
    """Return the files that a file includes, directly or indirectly.

    Parameters
    ----------
    path : the file
    within : files through which this file is included

    Raises
    ------
    ScenarioError
        If a file is missing or not well-formed, or includes itself.
    """
    within = (*within, path.resolve())
    root = _parsed_if_it_mentions(path)
    found = []
    for include in () if root is None else root.iter("include"):
        included = path.parent / include.get("href", "")
        if included.resolve() in within:
            raise ScenarioError(f"{included}: includes itself, by way of {path}")
        check_xml(included, asked_by=path)
        found += [included, *included_files(included, within)]
    return found


def _output_parameters(root: ElementTree.Element) -> Iterable[ElementTree.Element]:
    """Return the parameters of vehicles and traffic lights that name outputs."""
    for element in root.iter():
        for param in element.findall("param"):
            key = param.get("key", "")
            if _DEVICE_OUTPUT.fullmatch(key) or (element.tag == "tlLogic" and key in _OF_SIGNALS):
                yield param


def _parsed_if_it_mentions(path: Path) -> ElementTree.Element | None:
    """Return the content of a file that may name others; large networks and demand seldom do."""
    with opened(path) as file:
        content = file.read()
    if _PLAIN.match(content) and not _MENTIONS.search(content):
        return None
    return ElementTree.fromstring(content)


def opened(path: Path) -> IO[bytes]:
    """Return a file open for reading, whether it is compressed or not."""
    with path.open("rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
    return cast(IO[bytes], gzip.open(path, "rb")) if packed else path.open("rb")
