"""Reads the output of SUMO's SSM device, a second judge for what this package computes."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.arrays import FloatArray
from analysis.errors import AnalysisError

_UNDEFINED = "NA"


@dataclass(frozen=True, slots=True)
class SsmValue:
    """The extreme value of a measure, and when it was taken."""

    time: float
    value: float


@dataclass(frozen=True, slots=True)
class SsmConflict:
    """One conflict between two vehicles; a measure that SUMO writes as NA is ``None``."""

    ego: str
    foe: str
    begin: float
    end: float
    min_ttc: SsmValue | None
    max_drac: SsmValue | None
    pet: SsmValue | None
    times: FloatArray
    """Steps of the conflict, empty where SUMO wrote no trajectories [s]."""
    ttc: FloatArray
    """TTC at these steps, nan where undefined; empty without trajectories [s]."""
    drac: FloatArray


def read_ssm(path: Path) -> list[SsmConflict]:
    """Return the conflicts of an SSM output file.

    Raises
    ------
    AnalysisError
        When the file cannot be read, is not XML, or holds something else.
    """
    try:
        root = ElementTree.parse(path).getroot()
    except OSError as error:
        raise AnalysisError(f"{path}: cannot be read ({error.strerror})") from None
    except ElementTree.ParseError as error:
        line, column = error.position
        raise AnalysisError(f"{path}: truncated or not XML (line {line}, column {column + 1})") from None
    if root.tag != "SSMLog":
        raise AnalysisError(f"{path}: expected an SSMLog, found {root.tag!r}")
    return [_conflict(path, number, entry) for number, entry in enumerate(root.iter("conflict"), start=1)]


def _conflict(path: Path, number: int, entry: ElementTree.Element) -> SsmConflict:
    try:
        return SsmConflict(
            ego=entry.attrib["ego"],
            foe=entry.attrib["foe"],
            begin=float(entry.attrib["begin"]),
            end=float(entry.attrib["end"]),
            min_ttc=_value(entry.find("minTTC")),
            max_drac=_value(entry.find("maxDRAC")),
            pet=_value(entry.find("PET")),
            times=_span(entry.find("timeSpan")),
            ttc=_span(entry.find("TTCSpan")),
            drac=_span(entry.find("DRACSpan")),
        )
    except KeyError as error:
        raise AnalysisError(f"{path}: conflict {number} has no attribute {error}") from None
    except ValueError as error:
        raise AnalysisError(f"{path}: conflict {number}: {error}") from None


def _number(text: str) -> float:
    return math.nan if text == _UNDEFINED else float(text)


def _value(entry: ElementTree.Element | None) -> SsmValue | None:
    if entry is None or entry.attrib["value"] == _UNDEFINED:
        return None
    return SsmValue(_number(entry.attrib["time"]), _number(entry.attrib["value"]))


def _span(entry: ElementTree.Element | None) -> FloatArray:
    texts = [] if entry is None else entry.attrib["values"].split()
    return np.array([_number(text) for text in texts], dtype=np.float64)
