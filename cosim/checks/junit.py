"""A check as JUnit XML: one test suite for each target, one test case for each criterion and its subject."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from xml.etree import ElementTree

from analysis.files import completing
from cosim.checks.finding import Finding

# Characters that XML 1.0 does not allow; names and reasons may contain them.
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

_OF_ALL = {"failures": "failure", "errors": "error"}
"""Attributes and the elements that they count; the schema that Jenkins publishes allows no others here."""
_OF_SUITE = {**_OF_ALL, "skipped": "skipped"}


def write_junit(path: Path, findings: Sequence[Finding]) -> None:
    """Write the file; times are left out, so that the same check gives the same bytes."""
    root = ElementTree.Element("testsuites", {"name": "cosim check", **_counts(findings, _OF_ALL)})
    for name, group in groupby(findings, key=lambda one: one.target):
        of_target = list(group)
        suite = ElementTree.SubElement(
            root, "testsuite", {"name": _clean(name), **_counts(of_target, _OF_SUITE)}
        )
        for one in of_target:
            _add(suite, one)
    ElementTree.indent(root)
    content = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    with completing(path) as part:
        part.write_bytes(content)


def _counts(findings: Sequence[Finding], names: Mapping[str, str]) -> dict[str, str]:
    tags = [_tag(one) for one in findings]
    return {"tests": str(len(tags)), **{name: str(tags.count(tag)) for name, tag in names.items()}}


def _tag(one: Finding) -> str:
    if one.status == "pass":
        return ""
    if one.invalid:
        return "error"
    return "failure" if one.failed else "skipped"


def _add(suite: ElementTree.Element, one: Finding) -> None:
    subject = "".join(
        f" [{name} {value}]"
        for name, value in (("seed", one.seed), ("encounter", _judged_encounter(one)))
        if value is not None
    )
    where = ".".join(
        _clean(part).replace(".", "_") for part in (one.target, one.scenario_id, one.configuration)
    )
    case = ElementTree.SubElement(suite, "testcase", classname=where, name=_clean(one.criterion_id) + subject)
    tag = _tag(one)
    if not tag:
        return
    told = ElementTree.SubElement(case, tag, message=_clean(one.sentence))
    if tag != "skipped":
        told.set("type", one.status)
        told.text = _clean("\n".join(["", *details(one), ""]))


def _judged_encounter(one: Finding) -> int | None:
    return one.encounter_id if one.scope == "encounter" else None


def details(one: Finding) -> list[str]:
    """Return all that is needed to look into a finding, line by line."""
    lines = [one.sentence, f"judged: {one.subject}"]
    if one.ego_id:
        pedestrian = "" if one.ped_id is None else f", pedestrian {one.ped_id}"
        since = "" if one.t_start_s is None else f", from {one.t_start_s:g} s"
        lines.append(f"ego {one.ego_id}{pedestrian}{since}")
    if one.where:
        lines.append(f"where: {one.where}")
    if one.margin is not None:
        lines.append(f"margin: {one.margin:.6g}")
    if one.run:
        lines.append(f"files: {one.run}")
    if one.run and one.encounter_id is not None:
        lines.append(f"replay: in the report (cosim report), {one.run}, encounter_id {one.encounter_id}")
    if one.command:
        lines.append(f"again: {one.command}")
    return lines


def _clean(text: str) -> str:
    return _NOT_XML.sub("?", text)
