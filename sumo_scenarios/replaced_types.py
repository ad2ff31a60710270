"""Replaces vehicle types that a configuration declares."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.model import Scenario
from sumo_scenarios.sumocfg import SumoConfiguration
from sumo_scenarios.xml_files import check_xml

TYPE = "vType"


def types_file(scenario: Scenario) -> Path | None:
    """Return a scenario's file of types; ``None`` if it keeps those of its configuration.

    Raises
    ------
    ScenarioError
        If the file is missing or not well-formed.
    """
    folder = scenario.variant or scenario.folder
    if scenario.table is None or not scenario.table.types or folder is None:
        return None
    path = folder / scenario.table.types
    check_xml(path, asked_by=folder / "scenario.toml")
    return path


def with_types(configuration: SumoConfiguration, types: Path, work_dir: Path) -> SumoConfiguration:
    """Return a configuration with the types of a file in place of its own types with the same ids.

    Parameters
    ----------
    configuration
    types : file of vTypes
    work_dir : folder for copies of additional files without the replaced types

    Raises
    ------
    ScenarioError
        If the configuration has no type with one of these ids.
    """
    wanted = {element.get("id", "") for element in ElementTree.parse(types).getroot().iter(TYPE)}
    found: set[str] = set()
    files = [types]
    for path in configuration.additional_files:
        root = ElementTree.parse(path).getroot() if not path.name.endswith(".gz") else None
        mine = [] if root is None else [one for one in root.findall(TYPE) if one.get("id") in wanted]
        if root is None or not mine:
            files.append(path)
            continue
        found |= {one.get("id", "") for one in mine}
        for one in mine:
            root.remove(one)
        work_dir.mkdir(parents=True, exist_ok=True)
        target = work_dir / f"types-replaced-{path.name}"
        ElementTree.ElementTree(root).write(target, encoding="utf-8", xml_declaration=True)
        files.append(target)
    if wanted - found:
        raise ScenarioError(
            f"{types}: {min(wanted - found)!r} replaces nothing: no such type in the additional files of "
            f"{configuration.path.name}"
        )
    return replace(configuration, additional_files=tuple(files))
