"""Cases of a seed, one after the other."""

from __future__ import annotations

import gc
import importlib
import os
import pkgutil
from collections import Counter
from contextlib import redirect_stdout, suppress
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

from controllers import catalog
from cosim.cli import command_line
from tests.fuzz.cases import Case, cases, prepare, without_mistakes
from tests.fuzz.harness import judge

PACKAGES = ("cosim", "controllers", "analysis", "sumo_scenarios")
UNUSED = (
    *("analysis.page", "analysis.plots", "analysis.screening", "analysis.search", "analysis.validation"),
    *("cosim.api", "cosim.batches.dask_cluster", "cosim.gym", "cosim.inspection.picture", "cosim.screening"),
    *("cosim.search", "cosim.validation"),
)
"""What no case needs; some of it stands on large libraries."""
FROM_OUTSIDE = ("libsumo", "pandas", "pyarrow.pandas_compat", "rich.progress")


@dataclass
class Fuzzed:
    """How cases ended."""

    right: dict[str, str] = field(default_factory=dict)
    """How a case of each kind without a mistake ended, and what was wrong with that."""
    endings: Counter[tuple[str, str]] = field(default_factory=Counter)
    wrong: list[tuple[Case, str, str]] = field(default_factory=list)

    @property
    def count(self) -> int:
        """Number of cases."""
        return self.endings.total()


def load() -> None:
    """Load the product, so that no case, each of them a copy of this process, has to."""
    for package in PACKAGES:
        folder = importlib.import_module(package).__path__
        for module in pkgutil.walk_packages(folder, f"{package}."):
            if not module.name.endswith("__main__") and not module.name.startswith(UNUSED):
                importlib.import_module(module.name)
    for name in FROM_OUTSIDE:
        importlib.import_module(name)
    catalog.names()  # looks for plug-ins
    with redirect_stdout(StringIO()):
        command_line.main(["--help"])


def run_cases(folder: Path, count: int, number: int, keep: Path | None = None) -> Fuzzed:
    """Run so many cases of a seed in ``folder``, and return how they ended."""
    load()
    os.environ["COSIM_CACHE_DIR"] = str(folder / "networks")
    prepare(folder)
    found = Fuzzed()
    gc.freeze()
    for one in without_mistakes():
        found.right[one.kind] = ", ".join(filter(None, judge(one, folder)))

    @seed(number)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(cases(folder))
    def run(case: Case) -> None:
        ending, what = judge(case, folder)
        found.endings[case.kind, ending] += 1
        if what:
            told = " ".join((folder / "stderr").read_text("utf-8", "replace").split())[-400:]
            found.wrong.append((case, what, told))
            if keep is not None:
                place = keep / f"{len(found.wrong)}"
                place.mkdir(parents=True, exist_ok=True)
                (place / case.file).write_bytes(case.content)
                (place / "what.txt").write_text(f"{case.command}\n{what}\n{told}\n")

    with suppress(KeyboardInterrupt):  # the figures of what has been run are worth telling
        run()
    return found
