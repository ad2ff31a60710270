"""Files sent to other machines and back: those of a study's own scenarios, and those of finished runs."""

from __future__ import annotations

import io
import os
import tarfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from string import Template

from cosim.batches.job import Configuration
from cosim.errors import SimulationError
from sumo_scenarios import library
from sumo_scenarios.demand import placeholders
from sumo_scenarios.library import Scenario
from sumo_scenarios.network_cache import source_files
from sumo_scenarios.pedestrian_tables import TrajectoryTable
from sumo_scenarios.recorded_vehicles import vehicles_file
from sumo_scenarios.replaced_types import types_file
from sumo_scenarios.sumocfg import read_sumocfg


@dataclass(frozen=True, slots=True)
class Bundle:
    """The files of one scenario."""

    place: str
    """Where the scenario is on the machine that the batch was started on."""
    entry: str
    """The scenario's folder or configuration inside the archive."""
    archive: bytes


def bundles(configurations: Iterable[Configuration]) -> tuple[Bundle, ...]:
    """Return the files of every scenario that is not built in; every machine has the built-in ones.

    These are the files that the run's identity covers: scenario.toml with all files that it names, or a
    SUMO configuration with its network, routes and additional files. They keep their places relative to
    each other.
    """
    entries, files = _travelling(configurations)
    return tuple(_bundle(place, entries[place], some) for place, some in files.items())


@dataclass(frozen=True, slots=True)
class Common:
    """Files that scenarios yet to be written have in common; their other files are sent with each of them."""

    root: Path
    """Folder below which all files of the scenarios are: the root of the file system."""
    files: frozenset[Path]

    def packed(self) -> bytes:
        """Return an archive of these files."""
        return pack(self.root, sorted(self.files))

    def rest(self, configuration: Configuration) -> Bundle | None:
        """Return the files of a scenario that are not among these; ``None`` for a built-in one."""
        entries, files = _travelling([configuration])
        for place, some in files.items():
            own = [path for path in some if path not in self.files]
            entry = entries[place].relative_to(self.root).as_posix()
            return Bundle(place, entry, pack(self.root, own))
        return None


def common(folder: Path, configurations: Iterable[Configuration]) -> Common:
    """Return the files of scenarios that later ones, written below ``folder``, are made from."""
    _, files = _travelling(configurations)
    return Common(Path(folder.resolve().anchor), frozenset(path for some in files.values() for path in some))


def _travelling(configurations: Iterable[Configuration]) -> tuple[dict[str, Path], dict[str, list[Path]]]:
    """Return the folder or configuration of scenarios that are not built in, and their files, by place."""
    files: dict[str, set[Path]] = {}
    entries: dict[str, Path] = {}
    # Parameters may decide which files a scenario names; the controller does not.
    for one in {each.road: each for each in configurations}.values():
        if library.is_built_in(one.place):
            continue
        scenario, _ = library.with_parameters(library.load(one.place), dict(one.scenario_settings))
        entry = scenario.variant or scenario.folder or scenario.sumocfg or Path(one.place)
        entries[one.place] = entry.resolve()
        files.setdefault(one.place, set()).update(path.resolve() for path in _files(scenario))
    return entries, {place: sorted(some) for place, some in sorted(files.items())}


def _bundle(place: str, entry: Path, files: Sequence[Path]) -> Bundle:
    root = Path(os.path.commonpath([str(entry.parent), *(str(path.parent) for path in files)]))
    return Bundle(place, entry.relative_to(root).as_posix(), pack(root, files))


def _files(scenario: Scenario) -> Iterator[Path]:
    folder, table = scenario.folder, scenario.table
    for named in (types_file(scenario), vehicles_file(scenario)):
        if named is not None:
            yield named
    yield from (Path(each.file) for each in scenario.pedestrians if isinstance(each, TrajectoryTable))
    if scenario.variant is not None:
        yield scenario.variant / library.DEFINITION
        if folder is not None and folder.parent == library.LIBRARY:
            return  # every machine has the base
    if folder is not None and table is not None:
        yield folder / library.DEFINITION
        if table.network is not None:
            for paths in source_files(folder, table.network).values():
                yield from paths
        if table.demand is not None:
            values = placeholders(scenario, table)
            for name in (*table.demand.routes, *table.demand.additional):
                yield folder / Template(name).safe_substitute(values)
        if table.packaged_sumocfg:
            return  # comes with SUMO
    if scenario.sumocfg is not None:
        configuration = read_sumocfg(scenario.sumocfg)
        yield from (scenario.sumocfg, configuration.net_file)
        yield from (*configuration.route_files, *configuration.additional_files)


def unpack_bundle(one: Bundle, folder: Path) -> str:
    """Write the files below ``folder`` and return where the scenario is there."""
    unpack(one.archive, folder)
    return str(folder / PurePosixPath(one.entry))


def pack(root: Path, files: Iterable[Path]) -> bytes:
    """Return a compressed archive of files below ``root``."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz", compresslevel=1) as archive:
        for path in files:
            archive.add(path, path.relative_to(root).as_posix(), recursive=False)
    return buffer.getvalue()


def pack_folder(folder: Path) -> bytes:
    """Return a compressed archive of everything in a folder."""
    return pack(folder, sorted(path for path in folder.rglob("*") if path.is_file()))


def unpack(archive: bytes, folder: Path) -> None:
    """Write the files of an archive below ``folder``.

    Raises
    ------
    SimulationError
        If it holds anything but plain files, or a file that would be written elsewhere.
    """
    root = folder.resolve()
    with tarfile.open(fileobj=io.BytesIO(archive), mode="r:gz") as files:
        # Not every Python 3.11 has the filters of the standard library; ``pack`` packs plain files only.
        for member in files:
            place = (root / member.name).resolve()
            content = files.extractfile(member) if member.isfile() else None
            if content is None or not place.is_relative_to(root):
                raise SimulationError(f"an archive with {member.name!r} is not one of ours")
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content.read())
