"""Finds configurations of a study of which no run was begun, such as those of an interrupted batch."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from cosim.batches.study import StudyTable
from sumo_scenarios import library
from sumo_scenarios.variant import as_text

SENSING = "sensing"
Varied = Mapping[str, str]
"""Values that distinguish a configuration from others of the study."""
Pair = tuple[str, str]
"""Names of a scenario and a controller."""


def unstarted(study: StudyTable, begun: Mapping[Pair, Collection[Varied]]) -> Iterator[tuple[Pair, Varied]]:
    """Yield the configurations that were never begun.

    Nothing is loaded to find out which parameters a controller has, as this would execute its code. They are
    known from the runs of the same pair. A pair without any run is therefore one configuration.

    Parameters
    ----------
    study
    begun
        What varies in each configuration with a run, by pair.
    """
    for text, controller in itertools.product(study.scenarios, study.controllers):
        pair = (_name(text), controller)
        if pair not in begun:
            yield pair, {}
            continue
        known = begun[pair]
        models = study.sensing if any(SENSING in one for one in known) else ("",)
        for model in models:
            mine = [one for one in known if one.get(SENSING, "") == model]
            fixed = {SENSING: model} if model else {}
            keys = [key for key in study.vary if mine and key in mine[0]]
            for values in itertools.product(*(map(as_text, study.vary[key]) for key in keys)):
                varied = {**fixed, **dict(zip(keys, values, strict=True))}
                if varied not in known:
                    yield pair, varied


def _name(text: str) -> str:
    """Return the name of a scenario that a study names, which may no longer exist."""
    if library.is_built_in(text):
        return library.load(text).name
    path = Path(text)
    if path.name == library.DEFINITION:
        path = path.parent
    return path.stem if path.suffix == ".sumocfg" else path.name
