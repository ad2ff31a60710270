"""A check: all targets are validated first, then run, then judged, and the files are written."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from analysis.criteria.reading import EXAMPLE
from analysis.criteria.table import CRITERIA
from analysis.manifest import MANIFEST
from analysis.page.names import DATA, PAGE
from analysis.study.runs import STUDY_FILE
from cosim.batches import batch as batches
from cosim.batches.batch import Batch, BatchRequest, Shown
from cosim.batches.ledger import LOCK
from cosim.checks.baseline import Baseline, check_common, check_same_road, compare, read_baseline
from cosim.checks.evaluation import Evaluation
from cosim.checks.files import PACKAGE, check_junit, write_findings
from cosim.checks.finding import Finding, exit_code
from cosim.checks.target import Target, Wishes, expanded, read_target
from cosim.errors import InputError
from cosim.presentation.workbook import WORKBOOK
from cosim.recording import folders

DEFAULT_LEVEL = 0.05
_OURS = (CRITERIA.file, PACKAGE, MANIFEST, PAGE, DATA, WORKBOOK)
"""Files that a check and its report write to the check's folder."""


@dataclass(frozen=True, slots=True)
class CheckRequest:
    """A user's request for a check."""

    targets: tuple[str, ...]
    out: Path | None = None
    junit: Path | None = None
    wishes: Wishes = field(default_factory=Wishes)
    jobs: int | None = None
    drop_recordings: bool = False
    baseline: Path | None = None
    level: float = DEFAULT_LEVEL

    def command(self) -> str:
        """Return the command that repeats the check in a new folder."""
        words = ["cosim", "check", *self.targets]
        wishes = self.wishes
        for controller in wishes.controllers:
            words += ["--controller", controller]
        for key, setting in wishes.settings.items():
            words += ["--set", f"{key}={setting}"]
        flags: dict[str, object | None] = {
            "--seeds": wishes.seeds,
            "--filter": wishes.part,
            "--criteria": wishes.criteria,
            "--run-timeout-s": None if wishes.run_timeout_s is None else f"{wishes.run_timeout_s:g}",
            "--baseline": self.baseline,
            "--level": None if self.baseline is None else f"{self.level:g}",
        }
        for flag, value in flags.items():
            words += [] if value is None else [flag, str(value)]
        return shlex.join(words)


@dataclass(frozen=True, slots=True)
class Result:
    """Result of a check."""

    folder: Path
    findings: tuple[Finding, ...]
    stopped: str
    """Why the check ended early; empty if it did not."""
    evaluations: tuple[Evaluation, ...]
    """The evaluation of each target, from which the findings come."""

    @property
    def exit_code(self) -> int:
        """Return 0, 1 or 3."""
        return 3 if self.stopped else exit_code(self.findings)


@dataclass(frozen=True, slots=True)
class Check:
    """Targets whose configurations have all been checked, ready to be run."""

    request: CheckRequest
    folder: Path
    parts: tuple[tuple[Target, Batch], ...]
    baseline: Baseline | None

    def run(self, shown: Callable[[], Shown]) -> Result:
        """Make the missing runs, judge all runs, and write the files."""
        stopped, command = "", self.request.command()
        evaluations: list[tuple[Evaluation, Batch]] = []
        for target, batch in self.parts:
            if not stopped:
                stopped = batch.run(shown()).stopped
            evaluations.append((Evaluation(target, batch, stopped, command), batch))
        findings = [one for evaluation, _ in evaluations for one in evaluation.findings()]
        if self.baseline is not None:
            compared = compare(self.baseline, evaluations, self.request.level, command)
            order = [target.name for target, _ in self.parts]
            findings = sorted([*findings, *compared], key=lambda one: order.index(one.target))
        write_findings(self.folder, findings, self.request.junit)
        return Result(self.folder, tuple(findings), stopped, tuple(one for one, _ in evaluations))


@contextmanager
def prepared(
    request: CheckRequest, progress: Callable[[int, int], None] = lambda done, total: None
) -> Iterator[Check]:
    """Check everything that can be wrong, and yield the check; nothing is written yet.

    Raises
    ------
    InputError
        If a target, a criterion, the baseline or the folder cannot be used.
    """
    if not 0.0 < request.level < 1.0:
        raise InputError(f"--level: expected a probability above 0 and below 1, got {request.level:g}")
    texts = [text for given in request.targets for text in expanded(given)]
    targets = [read_target(text, request.wishes) for text in texts]
    _check_targets(targets, with_baseline=request.baseline is not None)
    if request.drop_recordings and any(target.cases for target in targets):
        raise InputError("--drop-recordings: the verdicts of suites are made from the recordings")
    folder = request.out or _free_folder(targets)
    check_folder(folder)
    check_junit(request.junit)
    baseline = None if request.baseline is None else read_baseline(request.baseline)
    if baseline is not None:
        check_common(baseline, [target.matrix for target in targets])
    with ExitStack() as stack:
        parts = []
        for target in targets:
            table = target.table if target.changed else None
            one = BatchRequest(
                target.study,
                folder / target.name,
                request.jobs,
                drop_recordings=request.drop_recordings,
                table=table,
            )
            parts.append((target, stack.enter_context(batches.prepared(one, progress))))
        if baseline is not None:
            check_same_road(baseline, [batch for _, batch in parts])
        yield Check(request, folder, tuple(parts), baseline)


def _check_targets(targets: Sequence[Target], with_baseline: bool) -> None:
    seen: set[str] = set()
    for target in targets:
        if target.name in seen:
            raise InputError(f"two targets are called {target.name}; expected different names")
        seen.add(target.name)
        if not (target.cases or with_baseline or any(target.criteria.values())):
            raise InputError(
                f"{target.study}: no criterion; expected in the scenario.toml or study file, or in a file "
                f"after --criteria, for instance {EXAMPLE}"
            )


def _free_folder(targets: Sequence[Target]) -> Path:
    name = f"check-{targets[0].name}" if len(targets) == 1 else "check"
    number = 1
    while (folders.DEFAULT_PARENT / f"{name}-{number}").exists():
        number += 1
    return folders.DEFAULT_PARENT / f"{name}-{number}"


def check_folder(folder: Path) -> None:
    """Refuse a folder that holds anything but the files of an earlier check.

    Raises
    ------
    InputError
        If the folder cannot be used; the message is one line.
    """
    folders.check_links(folder)
    try:
        if not folder.exists():
            return
        if not folder.is_dir():
            raise InputError(f"--out {folder}: expected a folder, this is a file")
        for path in folder.iterdir():
            ours = path.name in _OURS or path.suffix == ".xml"
            if not ours and not (path / STUDY_FILE).is_file() and not (path / LOCK).is_file():
                raise InputError(
                    f"--out {folder}: expected an empty or new folder, or the one of this check; "
                    f"this one has {path.name} in it"
                )
    except OSError as error:
        raise InputError(f"--out {folder}: {error.strerror}") from error
