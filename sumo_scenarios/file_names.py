"""File names as SUMO's programs read them: lists separated by commas, in which ``%`` begins a code.

A configuration that SUMO saved has ``%20`` for a blank. In an absolute name, SUMO also splits or decodes
commas and codes in the names of the user's own folders.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from urllib.parse import unquote


def split_names(text: str) -> list[str]:
    """Return the names in the value of a configuration's option.

    >>> split_names("the%20town.rou.xml, more.rou.xml,")
    ['the town.rou.xml', 'more.rou.xml']
    """
    names = (unquote(name.strip()) for name in os.path.expandvars(text).split(","))
    return [name for name in names if name]


def joined_names(names: Iterable[str]) -> str:
    """Return names as the value of a configuration's option, such that `split_names` returns the same names.

    >>> joined_names(["100%25.rou.xml", "a, b.rou.xml"])
    '100%2525.rou.xml,a%2C b.rou.xml'
    """
    return ",".join(name.replace("%", "%25").replace(",", "%2C") for name in names)


def plain_name(path: Path, work_dir: Path) -> str:
    """Return a name of a file that SUMO's programs read without splitting or decoding it.

    Parameters
    ----------
    path : the file
    work_dir : existing folder with a plain name; holds a link to the file, or to its folder, if the name of
        either is not plain

    Returns
    -------
    name : the file's own name wherever possible
    """
    if not _is_plain(path.name):
        return str(_linked(path, work_dir))
    return str(path if _is_plain(str(path.parent)) else _linked(path.parent, work_dir) / path.name)


def _is_plain(name: str) -> bool:
    return "," not in name and unquote(name) == name


def _linked(target: Path, work_dir: Path) -> Path:
    """Return a link to a file or a folder, with the ending that tells SUMO whether a file is compressed."""
    ending = "".join(suffix for suffix in target.suffixes if _is_plain(suffix)) if target.is_file() else ""
    number = 1
    while (link := work_dir / f"link-{number}{ending}").is_symlink() and link.readlink() != target.absolute():
        number += 1
    if not link.is_symlink():
        link.symlink_to(target.absolute(), target_is_directory=target.is_dir())
    return link
