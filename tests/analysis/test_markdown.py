"""Tables of Markdown pages."""

from pathlib import Path

import pytest

from analysis.markdown import table, table_of, write_below


def test_a_table_has_its_cells_as_they_are() -> None:
    rows = [["1.50", "True"], ["", "–"], ["a long cell", "1e5"]]
    assert table(["a", ""], rows).splitlines() == [
        "| a |  |",
        "| --- | --- |",
        "| 1.50 | True |",
        "|  | – |",
        "| a long cell | 1e5 |",
    ]


def test_a_table_without_rows_is_a_table() -> None:
    assert table(["a", "b"], []) == "| a | b |\n| --- | --- |"


def test_no_cell_breaks_out_of_its_row() -> None:
    assert table(["a|b"], [["x|y\nz"]]).splitlines() == ["| a\\|b |", "| --- |", "| x\\|y z |"]


def test_columns_of_numbers_stand_at_the_right() -> None:
    assert table(["a", "n"], [["x", "1"]], right=["n"]).splitlines()[1] == "| --- | --: |"


def test_keys_of_rows_are_heads() -> None:
    assert table_of([{"a": "x", "n": 1}]) == table(["a", "n"], [["x", "1"]])


@pytest.mark.parametrize("before", [None, "# Page\n\n## Tables\n\nold\n", "# Page\n\n\n"])
def test_only_what_stands_below_the_line_of_a_page_is_replaced(tmp_path: Path, before: str | None) -> None:
    page = tmp_path / "page.md"
    if before is not None:
        page.write_text(before, encoding="utf-8")
    write_below(page, "## Tables", "new\n", introduction="# Page\n")
    assert page.read_text(encoding="utf-8") == "# Page\n\n## Tables\n\nnew\n"
