"""Reads the elements of a route or additional file one after another, so that it may be of any size."""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, cast
from xml.etree import ElementTree


def elements(path: Path) -> Iterator[tuple[Path, ElementTree.Element]]:
    """Yield the root's children, each with the file it is in; included files are read in their place.

    Compressed files are read like plain ones.
    """
    with path.open("rb") as source:
        packed = source.read(2) == b"\x1f\x8b"
    with cast(BinaryIO, gzip.open(path, "rb")) if packed else path.open("rb") as file:
        root: ElementTree.Element | None = None
        depth = 0
        for event, element in ElementTree.iterparse(file, events=("start", "end")):
            if event == "start":
                root = element if root is None else root
                depth += 1
                continue
            depth -= 1
            if depth == 1 and root is not None:
                if element.tag == "include":
                    yield from elements(path.parent / element.get("href", ""))
                else:
                    yield path, element
                root.clear()
