"""Every command that a text shows is run, shortened, or says why it is not."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import pytest

from tests.documentation import command_blocks, reductions
from tests.documentation.command_blocks import Command

TO_RUN = {
    page: commands
    for page in command_blocks.pages()
    if (commands := [one for one in command_blocks.of_page(page) if not one.excuse])
}
SLOW_PAGES = [page for page, commands in TO_RUN.items() if any(reductions.is_slow(c.words) for c in commands)]
QUICK_PAGES = [
    page for page, commands in TO_RUN.items() if any(not reductions.is_slow(c.words) for c in commands)
]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty folder to be in, which Python looks for plug-ins in, too."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", f"{command_blocks.ROOT}:{tmp_path}")
    monkeypatch.setenv("COSIM_CACHE_DIR", str(tmp_path_factory.getbasetemp() / "networks"))
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "summary.md"))
    return tmp_path


def work_off(page: str, folder: Path, commands: list[Command], slow: bool) -> None:
    reductions.prepare(page, folder, slow)
    for command in commands:
        if reductions.is_prepared(page, command.words):
            continue
        begun = time.monotonic()
        code = reductions.run(reductions.shortened(command.words))
        print(f"{time.monotonic() - begun:.1f} s  {command.place}", file=sys.stderr)
        may_fail = any(reductions.begins(command.words, start) for start in reductions.MAY_FAIL_CRITERIA)
        assert code == 0 or (may_fail and code == 1), f"{command.place}: exit code {code}"
    if commands == TO_RUN[page]:
        for name in reductions.MADE.get(page, ()):
            assert (folder / name).exists(), f"{page}: its commands do not make {name}"


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.parametrize("page", QUICK_PAGES)
def test_the_quick_commands_of_a_text_work(page: str, folder: Path) -> None:
    work_off(page, folder, [one for one in TO_RUN[page] if not reductions.is_slow(one.words)], slow=False)


@pytest.mark.sumo
@pytest.mark.slow
@pytest.mark.parametrize("page", SLOW_PAGES)
def test_all_commands_of_a_text_work_one_after_the_other(page: str, folder: Path) -> None:
    work_off(page, folder, TO_RUN[page], slow=True)


def test_a_command_that_is_neither_a_program_nor_excused_is_found() -> None:
    text = "\n".join(
        [
            "Text.",
            "",
            "    no-such-program --at all",
            "",
            "<!-- no-run: takes an hour -->",
            "",
            "    cosim run slow",
            "",
            "<!-- no-run: needs a screen -->",
            "```sh",
            "cosim run midblock_zebra --gui  # live",
            "```",
            "- an entry",
            "",
            "    of two paragraphs",
            "",
            "```console",
            "$ cosim list metrics",
            "ttc",
            "```",
            "```toml",
            "cosim = 1",
            "```",
            "```yaml",
            "check:",
            "  script:",
            "    - cosim list suites",
            '    - "make it # no-run: is no target"',
            "```",
        ]
    )
    found = command_blocks.of_text(text, "page.md")
    assert [(one.line, one.words[0], one.words[1], one.excuse) for one in found] == [
        (3, "no-such-program", "--at", ""),
        (7, "cosim", "run", "takes an hour"),
        (11, "cosim", "run", "needs a screen"),
        (18, "cosim", "list", ""),
        (25, "cosim", "list", ""),
        (25, "make", "it", "is no target"),
    ]
    with pytest.raises(AssertionError, match="neither run nor excused"):
        reductions.run(found[0].words)


def test_each_entry_of_the_registry_is_of_a_command_that_a_text_shows() -> None:
    commands = [one.words for all_of_page in TO_RUN.values() for one in all_of_page]
    starts = (*reductions.SHORTER, *reductions.SLOW, *reductions.MAY_FAIL_CRITERIA)
    for start in starts:
        assert any(reductions.begins(words, start) for words in commands), " ".join(start)
    for page in (*reductions.PREPARATIONS, *reductions.SLOW_PREPARATIONS, *reductions.MADE):
        assert page in TO_RUN, page
    for page, prepared in reductions.PREPARED.items():
        assert page in reductions.PREPARATIONS
        assert set(prepared) <= {tuple(one.words) for one in TO_RUN[page]}
