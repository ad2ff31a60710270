"""How the numbers of a run are read from its encounters."""

from __future__ import annotations

import sys

from analysis.study.run_numbers import arrow_file


def test_what_arrow_reads_in_its_threads_is_none_of_pythons_memory() -> None:
    content = b"a,b\n1,2\n"
    before = sys.getrefcount(content)
    file = arrow_file(content)
    assert sys.getrefcount(content) == before
    assert file.read() == content
