"""Where a run's files go."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.errors import InputError
from cosim.recording import folders


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_folders_without_a_name_are_numbered() -> None:
    first, second = (folders.create(None, "zebra", "aeb", 7) for _ in range(2))
    assert (str(first), str(second)) == ("runs/zebra-aeb-7-1", "runs/zebra-aeb-7-2")


def test_an_empty_or_new_folder_is_taken_and_a_full_one_refused(tmp_path: Path) -> None:
    out = tmp_path / "a" / "b"
    assert folders.create(out, "zebra", "aeb", 1) == out
    assert folders.create(out, "zebra", "aeb", 1) == out
    (out / "something").touch()
    with pytest.raises(InputError, match="expected an empty or new folder"):
        folders.create(out, "zebra", "aeb", 1)


def test_a_folder_below_a_file_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="file"):
        folders.create(tmp_path / "file" / "below", "zebra", "aeb", 1)


def test_a_discarded_folder_is_gone() -> None:
    folder = folders.create(None, "zebra", "aeb", 1)
    (folder / "run.json").touch()
    folders.discard(folder)
    assert not folder.exists()
