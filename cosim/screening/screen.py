"""Ranks the crossings of a network by a batch of runs that record everybody."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from analysis.errors import AnalysisError
from analysis.recording.extent import EVERYBODY
from analysis.screening.writing import Changed, Screened, write_changes, write_ranking
from cosim.batches.batch import BatchRequest
from cosim.batches.study import study_of
from cosim.errors import InputError, SimulationError, reason_of
from cosim.inspection.inspection import crossing_ids
from cosim.presentation.notes import COARSE_STEP_S, JUDGED_STEP_S
from cosim.recording.folders import DEFAULT_PARENT
from sumo_scenarios import library

AGAINST = "against"
"""Folder of the alternative inside that of the base."""
NOBODY = "sumo"
"""Controller of runs without egos."""


@dataclass(frozen=True, slots=True)
class ScreenRequest:
    """A user's request for a ranking."""

    scenario: str
    seeds: str = "1-10"
    settings: Mapping[str, str] = field(default_factory=dict)
    begin_s: float | None = None
    """Simulated time from which on everybody counts; ``None`` for the end of the scenario's warm-up [s]."""
    end_s: float | None = None
    out: Path | None = None
    jobs: int | None = None
    scheduler: str | None = None
    again: str = ""
    """Command that continues after an interruption."""

    @property
    def folder(self) -> Path:
        """Folder of the batch and the ranking."""
        return DEFAULT_PARENT / f"screen-{Path(self.scenario).stem}" if self.out is None else self.out


def alternative(request: ScreenRequest, scenario: str | None, settings: Mapping[str, str]) -> ScreenRequest:
    """Return the request for the alternative of a comparison, with the same seeds and hours.

    Parameters
    ----------
    request
        The base.
    scenario
        Scenario of the alternative; ``None`` for that of the base.
    settings
        Scenario parameters that differ from the base's.
    """
    return replace(
        request,
        scenario=request.scenario if scenario is None else scenario,
        settings={**request.settings, **settings},
        out=request.folder / AGAINST,
    )


@dataclass(frozen=True, slots=True)
class Plan:
    """Runs from which the crossings will be ranked."""

    batch: BatchRequest
    notes: list[str]
    """Notes for the user, one line each."""
    crossings: frozenset[str]
    """Ids of the crossings of a SUMO configuration; empty for a scenario, whose network is not built yet."""


def planned(request: ScreenRequest) -> Plan:
    """Return the batch of runs from which the crossings are ranked.

    Raises
    ------
    InputError
        If a scenario, a time or a seed is invalid, or the network has no crossings.
    """
    try:
        scenario = library.load(request.scenario)
    except (library.ScenarioError, OSError) as error:
        raise InputError(str(error)) from error
    path = Path(request.scenario)
    configured = path.is_file() and path.name != library.DEFINITION
    crossings = crossing_ids(path) if configured else frozenset()
    if configured and not crossings:
        raise InputError(
            f"{request.scenario}: the network has no crossings to rank; cosim inspect prints the command "
            "that adds them"
        )
    if "ego_share" in request.settings:
        raise InputError("ego_share: a screening has no egos; vary ego_share in a study file for cosim batch")
    settings: dict[str, str | float] = {**request.settings, "ego_share": 0.0, **_times(request, scenario)}
    notes = []
    if "step_s" not in settings and scenario.step_s > COARSE_STEP_S:
        settings["step_s"] = JUDGED_STEP_S
        notes.append(
            f"steps of {JUDGED_STEP_S:g} s are simulated: conflicts cannot be judged with those of "
            f"{scenario.step_s:g} s that the configuration asks for; "
            f"--set step_s={scenario.step_s:g} keeps them"
        )
    content = {
        "scenarios": [request.scenario if library.is_built_in(request.scenario) else str(path.resolve())],
        "controllers": [NOBODY],
        "seeds": request.seeds,
        "record": EVERYBODY,
        "set": settings,
    }
    batch = BatchRequest(
        path,
        request.folder,
        request.jobs,
        request.scheduler,
        table=study_of(content, "cosim screen"),
        again=request.again,
    )
    return Plan(batch, notes, crossings)


def check_comparable(base: Plan, alt: Plan) -> None:
    """Refuse two networks that are known to have no crossing in common.

    Raises
    ------
    InputError
        If they have no crossing in common.
    """
    known = (base.crossings, alt.crossings)
    if all(known) and not base.crossings & alt.crossings:
        few = [", ".join(sorted(names)[:3]) for names in known]
        raise InputError(
            f"--against {alt.batch.study}: no crossing in common with {base.batch.study}: "
            f"{few[0]} there, {few[1]} here; crossings are compared by their id"
        )


def _times(request: ScreenRequest, scenario: library.Scenario) -> dict[str, float]:
    """Return the scenario parameters for the hours that count."""
    found = {}
    for option, name, time in (
        ("--from", "warmup_s", request.begin_s),
        ("--to", "duration_s", request.end_s),
    ):
        if time is None:
            continue
        if name in request.settings:
            raise InputError(f"{option} and --set {name}: expected only one of them")
        if time < scenario.begin_s:
            raise InputError(
                f"{option}: expected no time before the begin, {scenario.begin_s:g} s, got {time:g} s"
            )
        found[name] = time - scenario.begin_s
    return found


def ranked(request: ScreenRequest, least_pedestrians: float, by: str) -> Screened:
    """Rank the crossings from the finished runs by one of ``RANK_BY``, and write the ranking.

    Raises
    ------
    SimulationError
        If no run can be ranked, or the ranking cannot be written.
    """
    try:
        return write_ranking(request.folder, least_pedestrians, by)
    except (AnalysisError, OSError) as error:
        raise SimulationError(f"no ranking: {reason_of(error)}") from error


def compared(request: ScreenRequest, base: Screened, alt: Screened) -> Changed:
    """Compare an alternative with the base, and write the differences to the folder of the request.

    Raises
    ------
    SimulationError
        If they have no seed in common, or the differences cannot be written.
    """
    try:
        return write_changes(request.folder, base.counts, alt.counts)
    except (AnalysisError, OSError) as error:
        raise SimulationError(f"no comparison: {reason_of(error)}") from error
