"""Reads times and input files from a SUMO configuration."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.file_names import split_names
from sumo_scenarios.sumo_options import long_name
from sumo_scenarios.xml_files import check_xml

SUMO_TELEPORTS_AFTER_S = 300.0
"""Default of SUMO's ``time-to-teleport`` [s]."""


@dataclass(frozen=True, slots=True)
class SumoConfiguration:
    """The parts of a configuration that a run needs."""

    path: Path
    net_file: Path
    route_files: tuple[Path, ...]
    additional_files: tuple[Path, ...]
    begin_s: float
    end_s: float | None
    step_s: float
    lateral_resolution_m: float | None
    teleport_after_s: float
    """Time after which SUMO teleports a standing vehicle; never, if not positive [s]."""
    options: Mapping[str, str]
    """All options that the configuration sets, as texts, by SUMO's long names."""


def read_sumocfg(path: Path) -> SumoConfiguration:
    """Return the content of a configuration; its input files must exist and be well-formed XML.

    Raises
    ------
    ScenarioError
        If the configuration or a file that it names is missing or broken.
    """
    root_name = check_xml(path)
    if not root_name.lower().endswith("configuration"):
        raise ScenarioError(f"{path}: the root element is <{root_name}>; expected a SUMO <configuration>")
    options = _options(path)
    nets = _files(path, "net-file", options)
    if not nets:
        raise ScenarioError(f'{path}: names no network; expected <net-file value="..."/>')
    net_file = nets[0]
    root_name = check_xml(net_file, asked_by=path)
    if root_name != "net":
        raise ScenarioError(f"{net_file}: the root element is <{root_name}>; expected a SUMO network, <net>")
    others = {key: _files(path, key, options) for key in ("route-files", "additional-files")}
    for file in (*others["route-files"], *others["additional-files"]):
        check_xml(file, asked_by=path)
    lateral = _seconds(path, "lateral-resolution", options) or 0.0
    end_s = _seconds(path, "end", options)
    step_s = _seconds(path, "step-length", options)
    teleport_after_s = _seconds(path, "time-to-teleport", options)
    return SumoConfiguration(
        path=path,
        net_file=net_file,
        route_files=others["route-files"],
        additional_files=others["additional-files"],
        begin_s=_seconds(path, "begin", options) or 0.0,
        end_s=None if end_s is None or end_s < 0 else end_s,
        step_s=1.0 if step_s is None else step_s,
        lateral_resolution_m=lateral if lateral > 0 else None,
        teleport_after_s=SUMO_TELEPORTS_AFTER_S if teleport_after_s is None else teleport_after_s,
        options=options,
    )


def _options(path: Path) -> dict[str, str]:
    options = {}
    for element in ElementTree.parse(path).getroot().iter():
        value = element.get("value", element.get("v"))
        if value is not None:
            options[long_name(element.tag)] = os.path.expandvars(value)
    return options


def _files(path: Path, key: str, options: dict[str, str]) -> tuple[Path, ...]:
    return tuple(path.parent / name for name in split_names(options.get(key, "")))


def _seconds(path: Path, key: str, options: dict[str, str]) -> float | None:
    """Return a time given as seconds or as [days:]hours:minutes:seconds [s]."""
    text = options.get(key)
    if text is None:
        return None
    sign, parts = (-1.0, text[1:]) if text.startswith("-") else (1.0, text)
    seconds = 0.0
    try:
        numbers = [float(part) for part in parts.split(":")]
    except ValueError:
        raise ScenarioError(f"{path}: {key} is {text!r}; expected seconds or h:m:s") from None
    for number, scale in zip(reversed(numbers), (1.0, 60.0, 3600.0, 86400.0), strict=False):
        seconds += number * scale
    return sign * seconds
