"""Files that are complete as soon as they have their name."""

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from analysis.files import completing, read_csv, read_json, write_csv, write_json, write_text


def test_a_file_gets_its_name_when_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    with completing(path) as part:
        part.write_text("half")
        assert not path.exists()
    assert path.read_text() == "half"
    assert list(tmp_path.iterdir()) == [path]


def test_after_an_error_the_file_of_before_is_there_and_nothing_else(tmp_path: Path) -> None:
    def rows() -> Iterator[list[str]]:
        yield ["half"]
        raise OSError("disk full")

    path = write_text(tmp_path / "a.csv", "before")
    with pytest.raises(OSError, match="disk full"):
        write_csv(path, ["a"], rows())
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_json_has_one_layout_and_comes_back(tmp_path: Path) -> None:
    path = write_json(tmp_path / "a.json", {"b": [1, "ü"], "a": None})
    assert path.read_text("utf-8") == '{\n "b": [\n  1,\n  "ü"\n ],\n "a": null\n}\n'
    assert read_json(path) == {"b": [1, "ü"], "a": None}


def test_a_number_that_json_does_not_have_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="nan"):
        write_json(tmp_path / "a.json", {"a": math.nan})
    assert not list(tmp_path.iterdir())


def test_tables_of_comma_separated_values_come_back_as_texts(tmp_path: Path) -> None:
    path = write_csv(tmp_path / "a.csv", ["a", "b"], ([1, None], ["x,y", "z"]))
    assert path.read_bytes() == b'a,b\n1,\n"x,y",z\n'
    assert read_csv(path) == [{"a": "1", "b": ""}, {"a": "x,y", "b": "z"}]
