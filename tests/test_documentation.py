"""What the texts say exists."""

from __future__ import annotations

import re
import shlex
import types
from functools import cache
from pathlib import Path

import pytest
import typer.core
import typer.main

from analysis.encounters.case import prepare
from analysis.recording.reading import read_run
from analysis.results.metric_catalog import read_metric
from analysis.results.rows import measure
from analysis.thresholds import with_settings
from controllers import catalog
from controllers.interface import Controller
from controllers.outside import addresses
from controllers.settings import call, model_of
from cosim.cli import (
    analyse,
    batch,
    check,
    compare,
    conformance,
    export,
    listing,
    plot,
    replay,
    report,
    run,
)
from cosim.cli import inspect as inspect_command
from cosim.cli.command_line import app
from cosim.running.request import parse_settings
from cosim.sensing.catalog import PERFECT, build
from cosim.sensing.chosen import split
from sumo_scenarios import library
from tests.analysis.recorded import Ego, Person, line, write_run
from tests.documentation import command_blocks

ROOT = Path(__file__).resolve().parents[1]
SOURCES = [
    path
    for name in ("cosim", "controllers", "analysis", "sumo_scenarios", "studies")
    for path in (ROOT / name).rglob("*.py")
]
PAGES = ("CHANGELOG.md", *command_blocks.pages())
CITATION = re.compile(r"\[([A-Z][A-Za-z]*[A-Za-z0-9.-]*)\]_")
ENTRY = re.compile(r"^[-*]?\s*\*{0,2}\[([^\]]+)\]", re.MULTILINE)


def test_every_cited_key_has_an_entry_in_the_references() -> None:
    entries = set(ENTRY.findall((ROOT / "docs/references.md").read_text()))
    cited = {key: path for path in SOURCES for key in CITATION.findall(path.read_text())}
    missing = {key: str(path.relative_to(ROOT)) for key, path in cited.items() if key not in entries}
    assert not missing, f"not in docs/references.md: {missing}"


@pytest.mark.parametrize("name", PAGES)
def test_links_between_the_texts_lead_somewhere(name: str) -> None:
    page = ROOT / name
    for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
        assert (page.parent / target).exists(), f"{name} links to {target}, which does not exist"


def test_every_page_is_reached_from_the_readme() -> None:
    """The navigation of the site does not exist on a git host."""
    reached, new = set(), {ROOT / "README.md"}
    while new:
        reached |= new
        targets = (
            (page.parent / target).resolve()
            for page in new
            for target in re.findall(r"\]\(([^)#:]+\.md)[)#]", page.read_text())
        )
        new = set(targets) - reached
    assert {ROOT / name for name in PAGES} - reached == set()


LONGEST_READ = 750
"""Words of README.md with its commands: three minutes for somebody who reads 250 a minute."""


def test_the_readme_is_read_in_three_minutes() -> None:
    text = re.sub(r"<!--.*?-->", "", (ROOT / "README.md").read_text("utf-8"), flags=re.DOTALL)
    text = re.sub(r"\]\([^)]*\)", "]", text)  # where a link leads is not read
    words = re.findall(r"[A-Za-z0-9]\S*", text.replace("|", " "))
    assert len(words) <= LONGEST_READ, f"{len(words)} words"


def commands() -> list[str]:
    """Return every command line that a text or a help page shows."""
    shown = {shlex.join(one.words) for name in PAGES for one in command_blocks.of_page(name)}
    helps = [
        function.__doc__ or ""
        for function in (
            run.run,
            batch.batch,
            check.check,
            analyse.analyse,
            compare.compare,
            conformance.conformance,
            report.report,
            inspect_command.inspect,
            plot.plot,
            replay.replay,
            export.export,
            listing.show,
        )
    ]
    shown |= {line.strip() for text in helps for line in text.splitlines()}
    return sorted(line for line in shown if line.startswith("cosim "))


@cache
def run_by_tests() -> set[str]:
    """Return those that ``tests/documentation`` runs."""
    found = (one for name in PAGES for one in command_blocks.of_page(name))
    return {shlex.join(one.words) for one in found if not one.excuse}


@cache
def all_commands() -> typer.core.TyperGroup:
    """Return the command ``cosim``, whose signatures take a while to read."""
    group = typer.main.get_command(app)
    assert isinstance(group, typer.core.TyperGroup)
    return group


@pytest.mark.parametrize("line", commands())
def test_a_command_that_a_text_shows_is_one_that_can_be_given(line: str) -> None:
    name, *arguments = shlex.split(line)[1:]
    group = all_commands()
    with group.make_context("cosim", [name, *arguments]) as context:
        command = group.get_command(context, name)
        assert command is not None, f"there is no command {name!r}"
        with command.make_context(name, arguments, parent=context) as given:
            values = given.params
    if line in run_by_tests():
        return  # their scenarios, controllers and parameters are looked up then
    settings = values.get("settings") or []
    if name == "analyse":
        with_settings(parse_settings(settings))
    if name == "run":
        texts = parse_settings(settings)
        named = values["controller"] in catalog.names()
        assert named or values["controller"].startswith((addresses.PROCESS, addresses.FMU))
        if values["scenario"].endswith(".sumocfg"):
            assert any(values[key] for key in ("ego_route", "ego_vehicle", "ego_share"))
        else:
            model = values["sensing"] or PERFECT
            of_sensing, texts = split(texts, model, catalog.parameters(values["controller"]))
            build(model, of_sensing)
            _, leftover = library.with_parameters(library.load(values["scenario"]), texts)
            catalog.parse(values["controller"], leftover)


@pytest.mark.parametrize("name", PAGES)
def test_commands_and_flags_within_a_sentence_exist(name: str) -> None:
    group = all_commands()
    for text in re.findall(r"`cosim ([a-z][^`]*)`", (ROOT / name).read_text()):
        command, *others = text.split()
        with group.make_context("cosim", [command]) as context:
            found = group.get_command(context, command)
        assert found is not None, f"{name}: there is no command {command!r}"
        flags = {flag for parameter in found.params for flag in parameter.opts}
        for word in others:
            assert not word.startswith("--") or word in flags | {"--help"}, f"{name}: `cosim {text}`: {word}"


@cache
def parameters() -> set[str]:
    """Return the names of all parameters there are."""
    known = {"ego_route", "ego_vehicle", "ego_share"}  # of a study: docs/batches.md
    outside = [f"{addresses.PROCESS}program", f"{addresses.FMU}unit.fmu"]
    for controller in (*catalog.names(), *outside):
        known |= catalog.parameters(controller).keys() | catalog.moved(controller).keys()
    for scenario in library.names():
        known |= library.parameter_values(library.load(scenario)).keys()
    return known


@pytest.mark.parametrize("name", PAGES)
def test_parameters_within_a_sentence_exist(name: str) -> None:
    for text in re.findall(r"`--set ([a-z_]+)=", (ROOT / name).read_text()):
        assert text in parameters(), f"{name}: there is no parameter {text!r}"


@pytest.mark.parametrize("name", PAGES)
def test_files_that_a_text_names_exist(name: str) -> None:
    named = r"`((?:cosim|controllers|analysis|sumo_scenarios|studies|tests|benchmarks|docs)/[\w./-]+\.\w+)"
    for path in re.findall(named, (ROOT / name).read_text()):
        assert (ROOT / path).exists(), f"{name} names {path}, which does not exist"


def where_to_change_what() -> list[list[str]]:
    """Return the places that each row of the table in CONTRIBUTING.md names."""
    text = (
        (ROOT / "CONTRIBUTING.md").read_text().partition("## Where to change what")[2].partition("\n## ")[0]
    )
    rows = [line.split("|")[2] for line in text.splitlines() if line.startswith("| ")][1:]
    return [re.findall(r"`([^`]+)`", row) for row in rows]


def test_the_table_of_where_to_change_what_names_paths_that_exist() -> None:
    rows = where_to_change_what()
    assert len(rows) > 10  # the whole table was read
    for paths in rows:
        assert paths, f"a row without a path; the rows: {rows}"
        for path in paths:
            assert (ROOT / path).exists(), f"CONTRIBUTING.md names {path}, which does not exist"


@pytest.mark.parametrize("package", ["cosim", "controllers", "analysis"])
def test_every_room_stands_in_the_table_of_where_to_change_what(package: str) -> None:
    named = [path for row in where_to_change_what() for path in row]
    rooms = [file.parent.relative_to(ROOT).as_posix() for file in (ROOT / package).glob("*/__init__.py")]
    assert len(rooms) > 5
    assert not [room for room in rooms if not any(path.startswith(f"{room}/") for path in named)]


def test_make_targets_that_the_texts_name_exist() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    for page in PAGES:
        named = re.findall(r"^ *make ([a-z-]+)|`make ([a-z-]+)`", (ROOT / page).read_text(), re.MULTILINE)
        for target in (first or second for first, second in named):
            assert target in targets, f"{page} names make {target}"


def contributed(title: str) -> types.ModuleType:
    """Return the module that the contributing text shows in a section."""
    text = (ROOT / "CONTRIBUTING.md").read_text()
    (source,) = re.findall(rf"## {title}\n[^#]*?```python\n(.*?)```", text, re.DOTALL)
    module = types.ModuleType("contributed")
    exec(compile(source, "CONTRIBUTING.md", "exec"), module.__dict__)
    return module


def test_the_controller_in_the_contributing_text_works() -> None:
    module = contributed("Add a controller")
    build = module.__dict__["build"]
    made = model_of(build).model_validate({"acceleration": "0.5"})
    controller: Controller = call(build, made)
    assert callable(controller.decide)
    assert callable(controller.plan)


def test_the_metric_in_the_contributing_text_works(tmp_path: Path) -> None:
    ride = write_run(tmp_path, [Ego(line(0, 0, 10, 0))], [Person(line(20.0, 0, 0, 0))], duration=1.0)
    values, of_run = measure(read_metric("last_gap", contributed("Add a metric")), prepare(read_run(ride)))
    # The front is at 12.25 m at last, the disc begins at 19.75 m.
    assert list(values["last_gap_m"]) == pytest.approx([7.5])
    assert of_run["last_gap_min_m"] == pytest.approx(7.5)
