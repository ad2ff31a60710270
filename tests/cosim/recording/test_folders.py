"""Where a run's files go."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.errors import InputError
from cosim.recording import folders
from cosim.search.estimate import EstimateRequest
from cosim.search.search import FalsifyRequest
from tests.analysis.study.study_folders import write_study_run
from tests.cosim.batches.studies import write_study
from tests.cosim.cli.commands import ended
from tests.cosim.inspection.towns import build


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_folders_without_a_name_are_numbered() -> None:
    first, second = (folders.create(None, "zebra", "aeb", 7) for _ in range(2))
    assert (str(first), str(second)) == ("runs/zebra-aeb-7-1", "runs/zebra-aeb-7-2")


@pytest.mark.parametrize("controller", ["./patient.py", "../../patient.py", "process:./a program --fast"])
def test_a_controller_s_address_makes_no_folders_of_its_own(controller: str) -> None:
    run = folders.create(None, "zebra", controller, 7)
    search = FalsifyRequest("jaywalk_arterial", controller).folder
    estimate = EstimateRequest("jaywalk_arterial", controller).folder
    assert {one.parent for one in (run, search, estimate)} == {folders.DEFAULT_PARENT}
    plain = "process_._a_program_--fast" if "process" in controller else "patient.py"
    assert [one.name for one in (run, search, estimate)] == [
        f"zebra-{plain}-7-1",
        f"falsify-jaywalk_arterial-{plain}-1",
        f"estimate-jaywalk_arterial-{plain}-1",
    ]


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


@pytest.mark.parametrize("below", ["", "runs/1"])
@pytest.mark.parametrize("command", ["run", "batch", "check", "report", "inspect"])
def test_a_link_that_leads_nowhere_is_named_as_one(command: str, below: str, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "gone")
    town, study = build(tmp_path), write_study(tmp_path)
    given = {"batch": study, "report": write_study_run(tmp_path / "a", "sumo", 1), "inspect": town}
    flag = "--scaffold" if command == "inspect" else "--out"
    out = tmp_path / "link" / below
    done = ended(command, given.get(command, "midblock_zebra"), flag, out, code=2)
    what = f"{tmp_path / 'link'}" if below else "this"
    assert f"{flag} {out}: expected a folder, {what} is a link to {tmp_path / 'gone'}" in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "gone").exists()


def test_a_discarded_folder_is_gone() -> None:
    folder = folders.create(None, "zebra", "aeb", 1)
    (folder / "run.json").touch()
    folders.discard(folder)
    assert not folder.exists()
