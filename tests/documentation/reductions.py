"""How the commands of the texts are made short enough to be run by a test, and what they need beforehand.

A command is run as it stands, with ``SHORTER`` added where it begins so. What a page takes for granted, such as
a network or finished runs, is made by ``PREPARATIONS`` before its first command.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import sumo

from cosim.batches.study import study_of, study_text
from cosim.cli import main
from tests.analysis.trajectories import streets
from tests.cosim.inspection import towns
from tests.cosim.tracks import networks
from tests.documentation.command_blocks import ROOT, fences

Words = tuple[str, ...]

BRIEF = ("--set", "warmup_s=5", "--set", "ego_headway_s=5", "--duration-s", "10")
SHORT = (
    *("--set", "pedestrians_per_hour=900", "--set", "warmup_s=10"),
    *("--set", "ego_headway_s=5", "--duration-s", "30"),
)
"""So long that four encounters have taken place."""
ONE_CASE = ("--filter", "crossing_right_25_30kmh")

SHORTER: Mapping[Words, Words] = {
    ("cosim", "run", "suite:"): (),
    # With one car in three an ego, some set out at once.
    ("cosim", "run", "town.sumocfg", "--ego-share", "0.3"): ("--duration-s", "12"),
    ("cosim", "run", "town.sumocfg"): ("--duration-s", "25"),
    ("cosim", "run", "scenarios/town/scenario.sumocfg"): ("--duration-s", "12"),
    ("cosim", "run", "bus_stop_occlusion"): ("--set", "warmup_s=5", "--duration-s", "15"),
    ("cosim", "run"): BRIEF,
    ("cosim", "screen", "town.sumocfg"): ("--seeds", "1-2", "--to", "50"),
    ("cosim", "screen", "midblock_zebra"): ("--seeds", "1", "--to", "35"),
    ("cosim", "check", "suite:"): ONE_CASE,
    # tests/cosim/search checks a whole folder of failures.
    ("cosim", "check", "results/constant/failures"): ("--filter", "kind-01"),
    ("cosim", "check", "midblock_"): ("--set", "warmup_s=5", "--set", "duration_s=30"),
    ("cosim", "conformance", "--controller"): (),
    ("cosim", "conformance"): ("route",),
    ("cosim", "falsify"): (
        *("--budget", "10", "--set", "vehicles_per_hour=0", "--no-shrink", "--no-report"),
        *("--set", "warmup_s=1", "--set", "duration_s=24"),
    ),
    ("python", "-m", "studies.papers"): ("003",),
}
"""What is added to a command that begins with these words; the first that fits. The last word is a prefix."""

SLOW: Sequence[Words] = (
    ("cosim", "batch"),
    ("cosim", "compare", "results/"),
    ("cosim", "report", "results/"),
    ("cosim", "verify", "results/"),
    ("cosim", "check", "crossings.toml"),
    ("cosim", "check", "midblock_"),
    ("cosim", "check", "--results"),
    ("cosim", "check", "suite:fmvss127", "--filter"),
    ("cosim", "check", "suite:fmvss127", "--controller", "vo_mpc", "--out"),
    ("python", "-m", "studies.papers"),
    ("cosim", "replay"),
    ("cosim", "validate"),
    ("python", "benchmarks/predictors.py"),
)
"""Left to the slow tests; nothing else may need what they make. As above, the last word is a prefix."""

MADE: Mapping[str, Sequence[str]] = {
    "README.md": (
        "results/crossing-safety/report.html",
        "results/fmvss127.xml",
        "scenarios/town",
        "town.png",
    ),
    "docs/batches.md": ("results/study/runs.csv", "results/study/study.toml"),
    "docs/ci.md": ("check/junit.xml", "junit.xml", "checks/today/criteria.csv", "summary.md"),
    "docs/gymnasium.md": ("trained.py", "checks/trained/criteria.csv"),
    "docs/falsify.md": ("results/constant/kinds.csv", "results/constant/failures/seed-1.toml"),
    "docs/first-network.md": ("results/vo_mpc/runs.csv", "report/report.html"),
    "docs/inspect.md": ("town.png", "scenarios/town/scenario.toml"),
    "docs/openscenario.md": ("encounter-1/encounter-1.xosc", "fcd/fcd.xml"),
    "docs/own-controller.md": ("runs/midblock_zebra-patient-1-1/report.html", "checks/patient"),
    "docs/own-network.md": ("town.png", "results/town/report.html"),
    "docs/papers.md": ("results/papers/claims.csv",),
    "docs/plots.md": ("figures", "encounter-3.gif"),
    "docs/quick-start.md": ("results/first/report.html", "results.xml"),
    "docs/real-tracks.md": ("results/street/traffic_encounters.csv",),
    "docs/report.md": ("results/study/report.html", "results/two/report.html"),
}
"""Files and folders of which a page says that they are there after its last command."""

MAY_FAIL_CRITERIA: Sequence[Words] = (
    ("cosim", "check", "suite:fmvss127", "--controller", "patient"),
    ("cosim", "check", "suite:fmvss127", "--controller", "./trained.py"),
    ("cosim", "check", "results/constant/failures"),
)
"""Exit code 1 is an answer, too."""


PREPARED: Mapping[str, Sequence[Words]] = {
    "docs/openscenario.md": (("cosim", "run", "midblock_zebra", "--controller", "vo_mpc"),),
}
"""Commands of a page that its preparation has run, so long that the next ones find what they need."""


def begins(words: Sequence[str], start: Words) -> bool:
    """Tell whether a command begins with these words, the last of them being a prefix."""
    whole = len(start) - 1
    return tuple(words[:whole]) == start[:-1] and len(words) > whole and words[whole].startswith(start[-1])


def shortened(words: Sequence[str]) -> list[str]:
    """Return the reduced variant of a command."""
    added = next((more for start, more in SHORTER.items() if begins(words, start)), ())
    return [*words, *added]


def is_slow(words: Sequence[str]) -> bool:
    """Tell whether only the slow tests run a command."""
    return any(begins(words, start) for start in SLOW)


def is_prepared(page: str, words: Sequence[str]) -> bool:
    """Tell whether the preparation of a page has run this command."""
    return any(tuple(words) == one for one in PREPARED.get(page, ()))


def prepare(page: str, folder: Path, slow: bool) -> None:
    """Make what a page takes for granted; what only slow commands need is left out of the quick test."""
    for needed in PREPARATIONS.get(page, ()):
        needed(folder)
    if slow:
        for needed in SLOW_PREPARATIONS.get(page, ()):
            needed(folder)


def _town(folder: Path) -> None:
    """Make town.sumocfg, with a car ``car.12`` and a way over the edges e1, e2 and e3."""
    nodes = "".join(f'<node id="n{i}" x="{200 * i}" y="0"/>' for i in range(4))
    edges = "".join(
        f'<edge id="{name}" from="n{a}" to="n{b}" numLanes="2" speed="13.8"/>'
        for name, a, b in (
            *((f"e{i + 1}", i, i + 1) for i in range(3)),
            *((f"w{i + 1}", i + 1, i) for i in range(3)),
        )
    )
    (folder / "n.nod.xml").write_text(f"<nodes>{nodes}</nodes>")
    (folder / "e.edg.xml").write_text(f"<edges>{edges}</edges>")
    connections = '<crossing node="n1" edges="e1 w1" priority="true"/><crossing node="n2" edges="e2 w2"/>'
    (folder / "c.con.xml").write_text(f"<connections>{connections}</connections>")
    sources = ["-n", "n.nod.xml", "-e", "e.edg.xml", "-x", "c.con.xml", "--sidewalks.guess"]
    towns.call("netconvert", *sources, "-o", "town.net.xml", folder=folder)
    cars = '<flow id="car" begin="0" end="60" period="1"><route edges="e1 e2 e3"/></flow>'
    people = '<personFlow id="p" begin="0" end="60" period="5"><walk from="e1" to="e3"/></personFlow>'
    towns.configure(folder, cars + people)


def _street(folder: Path) -> None:
    """Make street.net.xml, and tracks.csv of people who walk over its crossing before cars."""
    networks.street(folder)
    streets.write(folder / "tracks.csv", streets.crowd())


def _site(folder: Path) -> None:
    """Make street.sumocfg, and tracks.csv of more people and cars."""
    networks.street(folder)
    networks.configure(folder)
    streets.write(folder / "tracks.csv", streets.rush())


def _benchmarks(folder: Path) -> None:
    (folder / "benchmarks").symlink_to(ROOT / "benchmarks")


def _crossing_safety(folder: Path) -> None:
    _reduced_study(ROOT / "studies/crossing_safety.toml", folder / "studies/crossing_safety.toml")


def _study(folder: Path) -> None:
    """Make the study.toml of the pages: that of batches.md for its own scenario, with fewer seeds."""
    _town(folder)
    (folder / "town").mkdir()
    for name in ("town.net.xml", "town.sumocfg", "town.rou.xml"):
        shutil.copy(folder / name, folder / "town")
    (text,) = fences("docs/batches.md", "toml")
    content = tomllib.loads(text)
    _write_study(content | {"vary": {"steps": [20]}, "sensing": ["perfect"]}, folder / "study.toml")


def _crossings(folder: Path) -> None:
    """Make the crossings.toml of ci.md, shorter, and the check that it takes for a baseline."""
    (text,) = (one for one in fences("docs/ci.md", "toml") if one.startswith("# crossings.toml"))
    _write_study(tomllib.loads(text), folder / "crossings.toml")
    _call("cosim", "check", "crossings.toml", "--out", "checks/release")
    shutil.copytree(folder / "checks/release", folder / "released")


def _finished_study(folder: Path) -> None:
    _study(folder)
    _call("cosim", "batch", "study.toml", "--out", "results/study", "--jobs", "2")


def _runs(*controllers: str, of: Words = SHORT) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        for name in controllers:
            # One that another page has needed is taken again.
            made = folder.parent / f"{name}-{'-'.join(of)}"
            if not made.exists():
                _call("cosim", "run", "midblock_zebra", "--controller", name, *of, "--out", str(made))
            shutil.copytree(made, folder / f"runs/midblock_zebra-{name}-1-1")

    return make


def _plug_in(folder: Path) -> None:
    """Install the controller of own-controller.md into the folder, as pip would by its pyproject.toml."""
    (code,) = fences("docs/own-controller.md", "python")
    (project,) = fences("docs/own-controller.md", "toml")
    content = tomllib.loads(project)
    (module,) = content["tool"]["setuptools"]["py-modules"]
    (folder / f"{module}.py").write_text(code)
    about = folder / f"{module}-1.dist-info"
    about.mkdir()
    name = content["project"]["name"]
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n")
    points = [
        f"[{group}]\n" + "".join(f"{key} = {value}\n" for key, value in names.items())
        for group, names in content["project"]["entry-points"].items()
    ]
    (about / "entry_points.txt").write_text("\n".join(points))


def _policy(folder: Path) -> None:
    """Save the policy of gymnasium.md and its training, which is one round of three policies here."""
    policy, training = (one for one in fences("docs/gymnasium.md", "py"))
    (folder / "policy.py").write_text(policy)
    minute = "SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0"
    assert minute in training
    ten = "standard_normal((10, "
    assert ten in training
    shorter = training.replace(minute, "SECONDS = 0.5").replace(ten, "standard_normal((3, ")
    (folder / "train.py").write_text(shorter)


def _reduced_study(source: Path, target: Path) -> None:
    _write_study(tomllib.loads(source.read_text("utf-8")), target)


def _write_study(content: dict[str, object], target: Path) -> None:
    """Write a study with two seeds and short runs."""
    settings = content.get("set", {})
    assert isinstance(settings, dict)
    reduced = {**settings, "duration_s": 25.0, "warmup_s": 5.0}
    if "ego_share" in settings:
        reduced["ego_share"] = 0.5  # a tenth of the few cars of so short a run may be none
    shorter = {"seeds": "1-2", "set": reduced}
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(study_text(study_of({**content, **shorter}, target.name)))


def _call(*words: str) -> None:
    code = run(words)
    assert code == 0, f"preparing: {' '.join(words)}: exit code {code}"


def run(words: Sequence[str]) -> int:
    """Run a command in the current folder and return its exit code."""
    if words[0] == "cosim":
        return main(words[1:])
    places = [Path(sys.executable).parent / words[0], Path(sumo.SUMO_HOME) / "bin" / words[0]]
    program = sys.executable if words[0] == "python" else next((str(p) for p in places if p.exists()), None)
    if program is None:
        raise AssertionError(f"no program {words[0]!r}: neither run nor excused by a no-run comment")
    return subprocess.run([program, *words[1:]], check=False).returncode


PREPARATIONS: Mapping[str, Sequence[Callable[[Path], None]]] = {
    "README.md": (_town, _crossing_safety),
    "docs/gymnasium.md": (_policy,),
    "docs/inspect.md": (_town,),
    "docs/openscenario.md": (_runs("vo_mpc"),),
    "docs/own-controller.md": (_plug_in,),
    "docs/plots.md": (_runs("vo_mpc"),),
    "docs/real-tracks.md": (_street,),
    "docs/validation.md": (_site,),
    "docs/report.md": (_runs("vo_mpc"), _runs("sumo", "aeb", of=BRIEF)),
}
SLOW_PREPARATIONS: Mapping[str, Sequence[Callable[[Path], None]]] = {
    "docs/batches.md": (_study,),
    "docs/ci.md": (_crossings,),
    "docs/prediction.md": (_benchmarks,),
    "docs/report.md": (_finished_study,),
    "docs/statistics.md": (_finished_study,),
    "docs/study-batch.md": (_crossing_safety,),
}
