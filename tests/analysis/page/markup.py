"""Reads a page strictly: what is opened is closed in order, names are unique, and what is named is there."""

from __future__ import annotations

from collections import Counter
from html.parser import HTMLParser

VOID = {"meta", "input", "br", "link", "img", "hr"}
LOADING = {"src", "href", "action", "data", "poster", "srcset"}


class Markup(HTMLParser):
    """The elements of a page, and what is wrong with it."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.problems: list[str] = []
        self.ids: Counter[str] = Counter()
        self.references: set[str] = set()
        self.loaded: set[str] = set()
        self.texts: list[str] = []
        self.elements: Counter[str] = Counter()
        self._open: list[str] = []
        self.feed(text)
        self.close()
        self.problems += [f"<{tag}> is not closed" for tag in self._open]
        self.problems += [f"id {name!r} {count} times" for name, count in self.ids.items() if count > 1]
        self.problems += [f"no element {name!r}" for name in sorted(self.references - set(self.ids))]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements[tag] += 1
        for name, count in Counter(name for name, _ in attrs).items():
            if count > 1:
                self.problems.append(f"<{tag}> has {name} {count} times")
        for name, value in attrs:
            value = value or ""
            if name == "id":
                self.ids[value] += 1
            elif name in ("for", "aria-labelledby", "aria-describedby"):
                self.references |= set(value.split())
            elif name in LOADING:
                if value.startswith("#"):
                    self.references.add(value[1:])
                else:
                    self.loaded.add(value)
            elif name == "clip-path" and value.startswith("url(#"):
                self.references.add(value[5:-1])
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self._open.pop()

    def handle_endtag(self, tag: str) -> None:
        if not self._open or self._open[-1] != tag:
            self.problems.append(f"</{tag}> closes {self._open[-1] if self._open else 'nothing'}")
            return
        self._open.pop()

    def handle_data(self, data: str) -> None:
        if data.strip():
            self.texts.append(" ".join(data.split()))
