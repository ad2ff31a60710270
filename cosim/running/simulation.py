"""Simulates one run: from a request to a folder with a recording."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from pyarrow import ArrowInvalid

from analysis.files import write_json
from analysis.manifest import CLAIM, MANIFEST
from analysis.recording.columns import SCHEMA_VERSION
from analysis.recording.extent import EVERYBODY
from analysis.sealing import seal_recording
from cosim.errors import CosimError, InputError, SimulationError, lacks_memory, reason_of
from cosim.processes import uninterrupted
from cosim.recording import folders, provenance
from cosim.recording.parquet_sink import PART, recover
from cosim.recording.recorder import Recorder
from cosim.running import compose
from cosim.running.compose import Composition
from cosim.running.request import RunRequest
from cosim.step import loop
from cosim.step.broadcast import Broadcast
from cosim.step.drivers import Departures
from cosim.step.loop import LoopTimes

Progress = Callable[[float, float | None], None]
"""Called with the simulated time and, if known, the time at which the run ends [s]."""
TELEPORTED = "SUMO teleported"
"""Beginning of the reason why a run is not valid although it went on to its end."""


@dataclass(frozen=True, slots=True)
class RunResult:
    """Result of a run."""

    folder: Path
    description: dict[str, Any]
    """The content of ``run.json``."""
    error: BaseException | None = None
    """Error that ended the simulation early; ``None`` if there was none."""

    @property
    def valid(self) -> bool:
        """Whether the run went on to its end undisturbed."""
        return bool(self.description["valid"])

    @property
    def invalid_reason(self) -> str:
        """Reason why the run is not valid, in one line; empty for a valid run."""
        return str(self.description["invalid_reason"] or "")


def run(
    request: RunRequest,
    progress: Progress = lambda time, end: None,
    begun: Callable[[Path], None] = lambda folder: None,
) -> RunResult:
    """Simulate and record a run; bad input raises, and a failure after the first step is part of the result.

    Parameters
    ----------
    request : what to run
    progress : called after every step
    begun : called with the run's folder before the first step

    Raises
    ------
    InputError
        If anything is found wrong before the first step; no folder is left behind.
    """
    folders.check(request.out)
    composition = compose.compose(request)
    try:
        inputs = composition.inputs
        folder = folders.create(request.out, inputs.scenario, inputs.controller, inputs.seed)
        begun(folder)
        try:
            with ExitStack() as last:
                return _simulate(composition, folder, progress, last)
        except InputError:
            folders.discard(folder)
            raise
    finally:
        composition.close()


def _simulate(composition: Composition, folder: Path, progress: Progress, last: ExitStack) -> RunResult:
    """Simulate, record and describe a run; from the end of the simulation until ``last``, interrupts wait.

    `timeout` sends two signals at once, and who presses Ctrl-C again must not lose the tables.
    """
    description = provenance.describe(composition.inputs, SCHEMA_VERSION)
    description["outputs_left_out"] = list(composition.outputs_left_out)
    recorder = _begun(folder, description)
    times = LoopTimes()
    started = perf_counter()
    reason: str | None = None
    defect: Exception | None = None
    ended_by: BaseException | None = None
    held: list[int] = []
    try:
        with recorder, _map_written(composition, recorder):
            try:
                _drive(composition, recorder, times, progress)
            finally:
                held = last.enter_context(uninterrupted())
    except CosimError as error:
        reason, ended_by = str(error), error
        if not recorder.ego_names and not recorder.records_everybody:
            # No ego drove, so nothing was recorded: the request cannot be met.
            raise InputError(reason) from error
    except KeyboardInterrupt as error:
        reason, ended_by = "interrupted", error
    except (OSError, MemoryError) as error:
        reason, ended_by = _could_not_go_on(error)
    except Exception as error:  # noqa: BLE001  a defect of this tool, told after the recording is complete
        reason, defect = f"internal error, {type(error).__name__}: {error}".replace("\n", " "), error
    if reason is None and recorder.teleports:
        reason = f"{TELEPORTED} {recorder.teleports} egos"
    if reason is None and not recorder.ego_names and not recorder.records_everybody:
        if composition.inputs.record == EVERYBODY:
            raise InputError("nobody to record: after the warm-up no vehicle or person is there or to come")
        raise InputError(f"no ego appeared before the run ended at {composition.end_time:g} s")
    _finish(description, recorder, times, perf_counter() - started, reason)
    _write_description(folder, description)
    if isinstance(ended_by, KeyboardInterrupt):
        held.clear()  # that has been done
    if defect is not None:
        raise SimulationError(f"{reason} (recorded so far: {folder})") from defect
    return RunResult(folder, description, ended_by)


def _could_not_go_on(error: OSError | MemoryError) -> tuple[str, OSError | MemoryError]:
    """Return why a run ended for want of room or memory, in words and as the error that it really is."""
    if isinstance(error, OSError) and not lacks_memory(error):
        return f"the recording could not be written: {reason_of(error)}", error
    lacking = error if isinstance(error, MemoryError) else MemoryError(str(error))
    return "there was not enough memory to go on", lacking


def _begun(folder: Path, description: Mapping[str, Any]) -> Recorder:
    """Write ``run.json`` and open the recording; if there is no room for them, nothing is left behind."""
    try:
        write_json(folder / "run.json", description)
        return Recorder(folder)
    except OSError as error:
        folders.discard(folder)
        raise SimulationError(f"the recording could not be written: {reason_of(error)}") from error


def keep_recorded(folder: Path, reason: str) -> dict[str, Any]:
    """Keep what a run had recorded when its process crashed, and return its ``run.json``.

    Parameters
    ----------
    folder : folder of the run
    reason : how the process ended
    """
    for part in sorted(folder.glob(f"*{PART}")):
        try:
            recover(part)
        except ArrowInvalid:
            part.unlink(missing_ok=True)  # not even the beginning was written
        except (OSError, MemoryError) as error:
            reason += f"; {part} could not be made a table: {reason_of(error)}"
    # It may say already that there are hashes, which the process did not come to write.
    description: dict[str, Any] = json.loads((folder / "run.json").read_bytes())
    description.update({"valid": False, "invalid_reason": reason, CLAIM: MANIFEST})
    _write_description(folder, description)
    return description


def _drive(composition: Composition, recorder: Recorder, times: LoopTimes, progress: Progress) -> None:
    end = composition.end_time
    window = () if composition.window is None else (composition.window,)
    record = Broadcast(recorder, Departures(composition.drivers), *window)
    loop.run(composition.world, composition.drivers, record, times, lambda time: progress(time, end))


@contextmanager
def _map_written(composition: Composition, recorder: Recorder) -> Iterator[None]:
    """Write the map at the end, and after a failure if the broken simulation still allows it."""
    world = composition.world
    try:
        yield
    except BaseException:
        # The failure is reported by the caller.
        with suppress(CosimError, OSError):
            recorder.write_map(world.map_areas())
        raise
    recorder.write_map(world.map_areas())


def _finish(
    description: dict[str, Any], recorder: Recorder, times: LoopTimes, wall_s: float, reason: str | None
) -> None:
    duration_s = 0.0
    if recorder.first_time is not None and recorder.last_time is not None:
        duration_s = recorder.last_time - recorder.first_time + float(description["step_s"])
    description.update(
        wall_s=round(wall_s, 3),
        wall_control_s=round(times.control, 3),
        wall_world_s=round(times.world, 3),
        duration_s=round(duration_s, 6),
        n_steps=times.steps,
        n_egos=len(recorder.ego_names),
        n_teleports=recorder.teleports,
        n_routes_restored=recorder.mishaps.routes_restored,
        n_steps_off_the_way=recorder.mishaps.off_the_way,
        egos_given_up=list(recorder.mishaps.given_up),
        cars_not_taken=list(recorder.mishaps.not_taken),
        egos_on_detours=list(recorder.mishaps.detours),
        n_others_teleported=recorder.mishaps.others_teleported,
        tight_bends={lane: round(off, 2) for lane, off in recorder.mishaps.tight_bends.items()},
        solvers=recorder.solves,
        valid=reason is None,
        invalid_reason=reason,
    )
    description[CLAIM] = MANIFEST


def _write_description(folder: Path, description: dict[str, Any]) -> None:
    """Write ``run.json`` and, last of all, the hashes of the recording.

    Raises
    ------
    SimulationError
        If there is no room for them.
    MemoryError
        If there is not enough memory; another process may still write them.
    """
    try:
        write_json(folder / "run.json", description)
        seal_recording(folder)
    except OSError as error:
        if lacks_memory(error):
            raise MemoryError(str(error)) from error
        reason = reason_of(error)
        raise SimulationError(f"the last files of {folder} could not be written: {reason}") from error
