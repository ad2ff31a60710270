"""Checks that XML files, plain or gzipped, are well-formed, and finds their root element."""

from __future__ import annotations

import gzip
import hashlib
import zlib
from pathlib import Path
from typing import IO
from xml.parsers import expat

from sumo_scenarios.errors import ScenarioError

_BLOCK = 1 << 20


def check_xml(path: Path, asked_by: Path | None = None) -> str:
    """Return the name of the root element of a well-formed file.

    Raises
    ------
    ScenarioError
        If the file is missing, unreadable or not well-formed, or refers to entities in other files; the
        message names ``asked_by`` as the file that refers to it.
    """
    named = f", which {asked_by} names" if asked_by else ""
    root: list[str] = []

    def opened(name: str, _attributes: dict[str, str]) -> None:
        if not root:
            root.append(name)

    def declared(name: str, _parameter: bool, value: str | None, *_where: str | None) -> None:
        if value is None:
            raise ScenarioError(f"{path}: expected XML without external entities, found &{name};")

    def skipped(name: str, _parameter: bool) -> None:
        raise ScenarioError(f"{path}: not well-formed XML: the entity &{name}; is not declared")

    parser = expat.ParserCreate()
    parser.StartElementHandler = opened
    parser.EntityDeclHandler = declared
    parser.SkippedEntityHandler = skipped
    try:
        with _open(path) as file:
            while block := file.read(_BLOCK):
                parser.Parse(block, False)
        parser.Parse(b"", True)
    except FileNotFoundError:
        raise ScenarioError(f"{path}: no such file{named}") from None
    except expat.ExpatError as error:
        raise ScenarioError(f"{path}: not well-formed XML: {error}") from None
    except (OSError, EOFError, zlib.error) as error:
        raise ScenarioError(f"{path}: cannot be read{named}: {error}") from None
    return root[0]


def _open(path: Path) -> IO[bytes]:
    if path.suffix == ".gz":
        return gzip.open(path, "rb")  # type: ignore[return-value]  # a GzipFile reads as any binary file does
    return path.open("rb")


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file's bytes, in hexadecimal."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(_BLOCK):
            digest.update(block)
    return digest.hexdigest()
