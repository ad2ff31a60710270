"""What may be wrong with a file: values, structure, bytes. Strategies that change what is right."""

from __future__ import annotations

import copy
from typing import Any
from xml.etree import ElementTree

from hypothesis import strategies as st

HOSTILE = (
    *("", " ", "-1", "0", "-0.0", "1e308", "-1e308", "1e-320", "nan", "inf", "-inf", "99999999999999999999"),
    *("x", "x y", "ä\u202e\U0001f6b6", "=1+1", "$end_s", "../../x", "/dev/null", "true", "[]", "a,b;c:d"),
    *("0,0", "0,0 nan,1", "\t", "é" * 300, "None", "random", "max", "%s%n", "'\"", "<a/>", "1:00:00", "50%"),
)
VALUES: tuple[Any, ...] = (
    *(True, False, 0, -1, 2**31, 2**63 - 1, 0.5, -0.0, 1e308, 5e-324, float("nan"), float("inf")),
    *([], [[]], [1, "a"], {}, {"x": 1}, [{}], *HOSTILE),
)


@st.composite
def changed_tables(draw: st.DrawFn, content: dict[str, Any]) -> dict[str, Any]:
    """Return the content of a TOML file with one to three mistakes."""
    changed = copy.deepcopy(content)
    for _ in range(draw(st.integers(1, 3))):
        places = _places(changed)
        if not places:
            break  # everything was taken out
        holder, key = draw(st.sampled_from(places))
        how = draw(st.sampled_from(("value", "value", "delete", "twice", "rename", "swap", "into_list")))
        if how == "value":
            holder[key] = copy.deepcopy(draw(st.sampled_from(VALUES)))
        elif how == "delete":
            holder.pop(key, None) if isinstance(holder, dict) else holder.pop(key)
        elif how == "twice" and isinstance(holder, list):
            holder.append(copy.deepcopy(holder[key]))
        elif how == "rename" and isinstance(holder, dict):
            holder[draw(st.sampled_from(("x", "", "Ä b", str(key) + "s")))] = holder.pop(key, 1)
        elif how == "swap":
            other, place = draw(st.sampled_from(places))
            holder[key], other[place] = copy.deepcopy(other[place]), _copy(holder, key)
        elif how == "into_list":
            holder[key] = [_copy(holder, key)]
    return changed


def _copy(holder: Any, key: Any) -> Any:
    """Return a copy of what a table or a list holds; a number where the key was taken out before."""
    return copy.deepcopy(holder.get(key, 1) if isinstance(holder, dict) else holder[key])


def _places(content: Any) -> list[tuple[Any, Any]]:
    """Return every key of every table, and every index of every list, with what holds it."""
    pairs = content.items() if isinstance(content, dict) else enumerate(content)
    found: list[tuple[Any, Any]] = []
    for key, value in list(pairs):
        found.append((content, key))
        if isinstance(value, dict | list):
            found += _places(value)
    return found


@st.composite
def changed_xml(draw: st.DrawFn, text: str) -> bytes:
    """Return an XML file with one to three mistakes in what it says; it stays well-formed."""
    root = ElementTree.fromstring(text)
    for _ in range(draw(st.integers(1, 3))):
        parents = [one for one in root.iter() if len(one)]
        if not parents:
            break
        parent = draw(st.sampled_from(parents))
        at = draw(st.integers(0, len(parent) - 1))
        how = draw(
            st.sampled_from(("value", "value", "value", "less", "more", "delete", "twice", "swap", "into"))
        )
        one = parent[at]
        if how == "delete":
            parent.remove(one)
        elif how == "twice":
            parent.insert(at, copy.deepcopy(one))
        elif how == "swap":
            other = draw(st.integers(0, len(parent) - 1))
            parent[at], parent[other] = parent[other], parent[at]
        elif how == "into":
            one.append(copy.deepcopy(draw(st.sampled_from(list(root.iter())))))
        elif how == "more":
            one.set(
                draw(st.sampled_from(("id", "file", "depart", "type", "x"))), draw(st.sampled_from(HOSTILE))
            )
        elif one.attrib and how == "less":
            del one.attrib[draw(st.sampled_from(sorted(one.attrib)))]
        elif one.attrib:
            one.set(draw(st.sampled_from(sorted(one.attrib))), draw(st.sampled_from(HOSTILE)))
    encoding = draw(st.sampled_from(("utf-8", "utf-8", "utf-16", "latin-1")))
    return bytes(ElementTree.tostring(root, encoding=encoding))


@st.composite
def changed_bytes(draw: st.DrawFn, content: bytes) -> bytes:
    """Return a file that was cut short, altered or told to have another encoding."""
    at = draw(st.integers(0, max(len(content) - 1, 0)))
    how = draw(st.sampled_from(("cut", "byte", "double", "encoding", "bom", "nothing", "zeros")))
    if how == "cut":
        return content[:at]
    if how == "byte":
        return content[:at] + bytes([draw(st.integers(0, 255))]) + content[at + 1 :]
    if how == "double":
        return content + content
    if how == "encoding":
        return content.decode("utf-8", "replace").encode(
            draw(st.sampled_from(("utf-16", "utf-32", "cp037"))), "replace"
        )
    if how == "bom":
        return b"\xff\xfe" + content
    return b"" if how == "nothing" else content[:at] + b"\0" * 8 + content[at:]
