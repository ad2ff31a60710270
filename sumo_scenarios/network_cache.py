"""Networks that netconvert builds on first use, cached under a hash of their sources."""

from __future__ import annotations

import hashlib
import os
import re
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import platformdirs

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.file_names import plain_name
from sumo_scenarios.schema import NetworkTable
from sumo_scenarios.sumo_installation import netconvert, sumo_home, sumo_version
from sumo_scenarios.xml_files import sha256

CACHE_VARIABLE = "COSIM_CACHE_DIR"
# Otherwise, nodes in the middle of a road and dead ends would get U-turns.
_ALWAYS = ("--no-turnarounds", "true", "--xml-validation", "never")
_COMMENT = re.compile(rb"<!--.*?-->\s*", re.DOTALL)


def cache_folder() -> Path:
    """Return the folder of built networks: ``$COSIM_CACHE_DIR``, or the user's own cache."""
    chosen = os.environ.get(CACHE_VARIABLE)
    return Path(chosen) if chosen else Path(platformdirs.user_cache_dir("sumo-cosim", appauthor=False))


def source_files(folder: Path, network: NetworkTable) -> dict[str, tuple[Path, ...]]:
    """Return the plain source files, by netconvert's option for them."""
    files = {
        "--node-files": (folder / network.nodes,),
        "--edge-files": (folder / network.edges,),
        "--type-files": (folder / network.types,) if network.types else (),
        "--connection-files": tuple(folder / name for name in network.connections),
    }
    return {option: paths for option, paths in files.items() if paths}


def build_network(folder: Path, network: NetworkTable) -> Path:
    """Return the network file, from the cache if these sources were built before and the file is unchanged.

    The comment in which netconvert writes date and paths is removed, so that the same sources give the same
    bytes. The file gets its final name only when it is complete, so that processes can build the same network
    at the same time.

    Raises
    ------
    ScenarioError
        If a source is missing, or netconvert refuses the sources.
    """
    sources = source_files(folder, network)
    target = cache_folder() / f"{folder.name}-{_key(sources, network.netconvert)}.net.xml"
    told = target.with_name(f"{target.name}.sha256")
    try:
        if told.read_text() == sha256(target):
            return target
    except (OSError, UnicodeDecodeError):
        pass  # no cached network, or no readable hash of it: build it again
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent, prefix=".building-") as work:
            stripped = Path(work) / "stripped.net.xml"
            stripped.write_bytes(_COMMENT.sub(b"", _built(folder, sources, network.netconvert)))
            digest = Path(work) / "digest"
            digest.write_text(sha256(stripped))
            os.replace(stripped, target)
            os.replace(digest, told)
    except OSError as error:
        raise ScenarioError(
            f"{target.parent}: cannot write the network cache: {error.strerror}; "
            f"set {CACHE_VARIABLE} to another folder"
        ) from error
    return target


def _key(sources: dict[str, tuple[Path, ...]], further: Sequence[str]) -> str:
    digest = hashlib.sha256(repr((sumo_version(), _ALWAYS, tuple(further))).encode())
    for option, paths in sources.items():
        for path in paths:
            try:
                content = path.read_bytes()
            except OSError as error:
                raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from error
            digest.update(f"{option} {len(content)} ".encode())
            digest.update(content)
    return digest.hexdigest()[:24]


def _built(folder: Path, sources: dict[str, tuple[Path, ...]], further: Sequence[str]) -> bytes:
    command = [str(netconvert())]
    environment = {**os.environ, "SUMO_HOME": str(sumo_home())}
    with tempfile.TemporaryDirectory(prefix="cosim-") as work:
        for option, paths in sources.items():
            command += [option, ",".join(plain_name(path, Path(work)) for path in paths)]
        output = Path(work) / "raw.net.xml"
        command += [*_ALWAYS, *further, "--output-file", str(output)]
        result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        if result.returncode == 0 and output.is_file():
            return output.read_bytes()
    lines = [line for line in (result.stderr + result.stdout).splitlines() if line.startswith("Error")]
    reason = " ".join(lines) or f"netconvert ended with {result.returncode}"
    raise ScenarioError(f"{folder.name}: netconvert cannot build the network: {reason}")
