"""The files that belong to a network or a SUMO configuration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cosim.errors import InputError
from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.sumocfg import read_sumocfg
from sumo_scenarios.xml_files import check_xml


@dataclass(frozen=True, slots=True)
class Source:
    """A network, and the demand and options of its configuration if there is one."""

    path: Path
    net_file: Path
    configured: bool = False
    """Whether the source is a configuration; a network alone has neither demand nor options."""
    route_files: tuple[Path, ...] = ()
    additional_files: tuple[Path, ...] = ()
    options: Mapping[str, str] = field(default_factory=dict)
    begin_s: float = 0.0
    end_s: float | None = None
    step_s: float = 0.1

    @property
    def name(self) -> str:
        """The file's name without suffixes: ``town`` for ``town.net.xml.gz``.

        >>> Source(Path("a/town.net.xml.gz"), Path("a/town.net.xml.gz")).name
        'town'
        """
        return self.path.name.split(".")[0] or "scenario"


def read_source(path: Path) -> Source:
    """Return the files behind a ``.net.xml``, ``.net.xml.gz`` or ``.sumocfg``.

    Raises
    ------
    InputError
        If a file is missing or broken, or its root element is that of another kind of file.
    """
    try:
        root = check_xml(path)
        if root == "net":
            return Source(path, path)
        if not root.lower().endswith("configuration"):
            raise InputError(
                f"{path}: the root element is <{root}>; expected a SUMO network, <net>, or a <configuration>"
            )
        found = read_sumocfg(path)
    except ScenarioError as error:
        raise InputError(str(error)) from error
    return Source(
        path,
        found.net_file,
        True,
        found.route_files,
        found.additional_files,
        found.options,
        found.begin_s,
        found.end_s,
        found.step_s,
    )
