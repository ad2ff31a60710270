"""The subject of a figure: one ego over its trip, or one encounter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.arrays import FloatArray
from analysis.encounters.case import Case
from analysis.encounters.finding import Encounter
from analysis.errors import AnalysisError
from analysis.recording.tracks import Track


class SceneError(AnalysisError):
    """The run does not have an ego or encounter; the message names those that exist."""


@dataclass(frozen=True, slots=True)
class Scene:
    """An ego and a window of time in a recorded run."""

    case: Case
    ego: str
    number: int | None
    """Number of the encounter, from 1 as in encounters.csv; ``None`` for the ego's whole trip."""
    first: int
    """Fine index of the first sample."""
    last: int

    @property
    def name(self) -> str:
        """Name of the scene in titles."""
        if self.number is None:
            return f"ego {self.ego}"
        return f"encounter {self.number}: ego {self.ego}, pedestrian {self.encounters[0].person.name}"

    @property
    def encounters(self) -> list[Encounter]:
        """The encounters of this ego that are shown."""
        if self.number is not None:
            return [self.case.encounters[self.number - 1]]
        return [one for one in self.case.encounters if one.ego.name == self.ego]

    @property
    def begin_s(self) -> float:
        """Simulated time of the first sample [s]."""
        return float(self.case.grid.time[self.first])

    @property
    def end_s(self) -> float:
        """Simulated time of the last sample [s]."""
        return float(self.case.grid.time[self.last])

    def pieces(self) -> list[Piece]:
        """Return the ego's track within the window, in several pieces if the recording has gaps."""
        return self._within(self.case.egos, {self.ego})

    def persons(self) -> list[Piece]:
        """Return the tracks of the pedestrians of the shown encounters."""
        return self._within(self.case.persons, {one.person.name for one in self.encounters})

    def ttc(self) -> list[tuple[str, FloatArray, FloatArray]]:
        """Return pedestrian, times [s] and TTC [s] of each shown encounter; nan without a collision course.

        encounters.csv has the smallest of these values.
        """
        samples = self.case.samples
        shown = [self.number - 1] if self.number is not None else range(len(self.case.encounters))
        found = []
        for index in shown:
            encounter = self.case.encounters[index]
            if encounter.ego.name == self.ego:
                own = samples.owner == index
                values = samples.ttc[own]
                finite = np.where(np.isfinite(values), values, np.nan)
                found.append((encounter.person.name, samples.time[own], finite))
        return found

    def _within(self, tracks: Sequence[Track], names: set[str]) -> list[Piece]:
        chosen = [track for track in tracks if track.name in names]
        pieces = []
        for track in chosen:
            first, last = max(track.first, self.first), min(track.last, self.last)
            if first <= last:
                pieces.append(Piece(track, first, last, self.case.grid.time[first : last + 1]))
        return pieces


@dataclass(frozen=True, slots=True)
class Piece:
    """The part of a track that lies within a window."""

    track: Track
    first: int
    last: int
    time: FloatArray

    @property
    def part(self) -> slice:
        """Slice of the track's arrays."""
        return slice(self.first - self.track.first, self.last - self.track.first + 1)

    @property
    def x(self) -> FloatArray:
        """[m]"""
        return self.track.x[self.part]

    @property
    def y(self) -> FloatArray:
        """[m]"""
        return self.track.y[self.part]

    @property
    def heading(self) -> FloatArray:
        """[rad]"""
        return self.track.heading[self.part]


def choose(case: Case, ego: str | None, number: int | None) -> Scene:
    """Return the scene of an encounter or of an ego's trip; without a name, of the first ego's trip.

    Raises
    ------
    SceneError
        If there is no such ego or encounter, or the encounter belongs to another ego.
    """
    egos = list(dict.fromkeys(track.name for track in case.egos))
    if ego is not None and ego not in egos:
        raise SceneError(f"no ego {ego!r} in {case.run.folder}; there are: {', '.join(egos)}")
    if number is not None:
        count = len(case.encounters)
        if not 1 <= number <= count:
            there = f"1 to {count}" if count else "none"
            raise SceneError(f"no encounter {number} in {case.run.folder}; there are: {there}")
        encounter = case.encounters[number - 1]
        if ego not in (None, encounter.ego.name):
            raise SceneError(f"encounter {number} is one of ego {encounter.ego.name!r}, not of {ego!r}")
        return Scene(case, encounter.ego.name, number, encounter.first, encounter.last)
    chosen = ego if ego is not None else egos[0]
    tracks = [track for track in case.egos if track.name == chosen]
    return Scene(case, chosen, None, min(t.first for t in tracks), max(t.last for t in tracks))
