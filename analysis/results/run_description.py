"""The columns of runs.csv that are not metrics: what ran, when, and whether it ended well."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.encounters.whole_run import WholeRun
from analysis.results.origin import CONDITIONS, CONFIGURATION, IDENTITY, Origin
from analysis.tables.column import at_least_0, count, flag, text


@dataclass(frozen=True, slots=True)
class ListedRun:
    """A run, from which these columns are made."""

    origin: Origin
    whole: WholeRun

    @property
    def wall_rtf(self) -> float | None:
        """Simulated time divided by wall-clock time."""
        wall, duration = self.origin.meta.get("wall_s"), self.origin.meta.get("duration_s")
        return duration / wall if wall and duration is not None else None

    @property
    def valid(self) -> bool:
        """Whether the run reached its end without a fault."""
        return bool(self.origin.meta.get("valid", False))

    @property
    def egos_given_up(self) -> int | None:
        """How many egos were given up; ``None`` if the run does not say."""
        names = self.origin.meta.get("egos_given_up")
        return None if names is None else len(names)


COLUMNS = (
    *IDENTITY,
    *CONFIGURATION,
    text("controller", "name of the controller", source="origin.meta.controller", required=True),
    text("tool_version", "version of this tool", source="origin.meta.tool_version"),
    text("git_sha", "commit of the checkout that ran", source="origin.meta.git_sha"),
    text("sumo_version", "version of SUMO", source="origin.meta.sumo_version"),
    text("wall_start_utc", "wall-clock time at the start, ISO 8601", source="origin.meta.start_utc"),
    at_least_0("wall_s", "s", "wall-clock time of the run", source="origin.meta.wall_s"),
    at_least_0("wall_rtf", "1", "simulated time over wall-clock time", source="wall_rtf"),
    at_least_0("step_s", "s", "step of the simulation", source="whole.run.step_s", required=True),
    at_least_0("warmup_s", "s", "simulated before the recording", source="origin.meta.warmup_s"),
    at_least_0("duration_s", "s", "recorded time", source="origin.meta.duration_s"),
    flag("valid", "the run went to its end without a fault", source="valid", required=True),
    text("invalid_reason", "the fault", source="origin.meta.invalid_reason"),
    *CONDITIONS,
    count("n_teleports", "egos that SUMO teleported", source="origin.meta.n_teleports"),
    count("n_egos_given_up", "egos handed back to SUMO's driver as they were stuck", source="egos_given_up"),
)
