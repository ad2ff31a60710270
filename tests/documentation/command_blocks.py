"""The commands that the texts show: blocks of a shell, and the steps of CI jobs in YAML.

A command that no test runs says why: in a comment ``<!-- no-run: reason -->`` above its block, which a page does
not show, or at the end of its line as ``# no-run: reason``.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml  # type: ignore[import-untyped]

ROOT = Path(__file__).resolve().parents[2]
SHELL = ("", "console", "sh", "bash", "shell")
"""Languages of a fence that make it a block of commands; no language at all is one of them."""

_EXCUSE = re.compile(r"<!-- no-run: (.*\S) -->")
_EXCUSED_LINE = re.compile(r"# no-run: (.*\S)")


@dataclass(frozen=True, slots=True)
class Command:
    """One command line of a text."""

    page: str
    line: int
    text: str
    excuse: str = ""

    @property
    def words(self) -> list[str]:
        """What a shell would make of it; its comment is left out."""
        return shlex.split(self.text, comments=True)

    @property
    def place(self) -> str:
        """Where it stands, for the message of a test."""
        return f"{self.page}:{self.line}: {self.text}"


def pages() -> list[str]:
    """Return every text that shows commands."""
    texts = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
    return [str(path.relative_to(ROOT)) for path in texts]


def of_page(page: str) -> list[Command]:
    """Return the commands of a text, from above to below."""
    return of_text((ROOT / page).read_text("utf-8"), page)


def of_text(text: str, page: str) -> list[Command]:
    """Return the commands of a text, from above to below."""
    found: list[Command] = []
    lines = text.splitlines()
    number = 0
    while number < len(lines):
        line = lines[number]
        if line.startswith("```"):
            end = next((i for i in range(number + 1, len(lines)) if lines[i].startswith("```")), len(lines))
            found += _of_fence(
                line[3:].strip(), lines[number + 1 : end], number + 2, page, _above(lines, number)
            )
            number = end + 1
        elif line.startswith("    ") and _stands_alone(lines, number):
            end = number
            while end < len(lines) and lines[end].startswith("    "):
                end += 1
            found += _of_shell(lines[number:end], number + 1, page, _above(lines, number))
            number = end
        else:
            number += 1
    return found


def fences(page: str, language: str) -> list[str]:
    """Return the contents of the fenced blocks of a language."""
    text = (ROOT / page).read_text("utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def _of_fence(language: str, lines: list[str], first: int, page: str, excuse: str) -> list[Command]:
    if language == "yaml":
        steps = _steps(yaml.safe_load("\n".join(lines)))
        return [Command(page, first, step, excuse or _excuse_of_line(step)) for step in steps]
    return _of_shell(lines, first, page, excuse) if language in SHELL else []


def _of_shell(lines: list[str], first: int, page: str, excuse: str) -> list[Command]:
    """Return the commands; where some begin with a prompt, the other lines are what these print."""
    texts = [(number, line.strip()) for number, line in enumerate(lines, first)]
    prompted = [(number, text.removeprefix("$ ")) for number, text in texts if text.startswith("$ ")]
    return [
        Command(page, number, text, excuse or _excuse_of_line(text))
        for number, text in prompted or texts
        if text and not text.startswith("#")
    ]


def _steps(content: Any) -> list[str]:
    """Return the command lines of the jobs of GitHub Actions and of GitLab."""
    jobs = content.get("jobs", content)
    found: list[str] = []
    for job in jobs.values():
        found += [step["run"] for step in job.get("steps", []) if "run" in step]
        found += [*job.get("before_script", []), *job.get("script", [])]
    return found


def _above(lines: list[str], number: int) -> str:
    """Return the reason in the comment directly above a block, or nothing."""
    above = [line for line in lines[max(number - 2, 0) : number] if line.strip()]
    found = _EXCUSE.fullmatch(above[-1].strip()) if above else None
    return found[1] if found else ""


def _excuse_of_line(text: str) -> str:
    found = _EXCUSED_LINE.search(text)
    return found[1] if found else ""


def _stands_alone(lines: list[str], number: int) -> bool:
    """Tell an indented block from the second line of a list's entry."""
    before = [line for line in lines[:number] if line.strip()]
    first = number == 0 or not lines[number - 1].strip() or bool(_EXCUSE.fullmatch(lines[number - 1].strip()))
    return first and not (before and re.match(r"\s*([-*]|\d+\.) ", before[-1]))
