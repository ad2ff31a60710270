"""The folder of a study: whole runs only, of one study only, from the same inputs only."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from cosim.batches import identity as identity_module
from cosim.batches.identity import Identity, differences, identity_of, source_digest
from cosim.batches.job import Job
from cosim.batches.ledger import Ledger
from cosim.batches.outcome import LOG, RUN, Outcome
from cosim.errors import InputError
from cosim.recording.provenance import Inputs
from cosim.running.compose import inputs_of
from tests.cosim.batches.studies import rows, some_job, write_study

JOB = some_job()


@pytest.fixture(scope="module")
def inputs() -> Inputs:
    return inputs_of(JOB.request())


@pytest.fixture(scope="module")
def identity(inputs: Inputs) -> Identity:
    return identity_of(inputs, "source")


@pytest.fixture
def ledger(tmp_path: Path) -> Iterator[Ledger]:
    one = Ledger(tmp_path / "out")
    with one.opened(write_study(tmp_path)):
        yield one


def attempt(ledger: Ledger, identity: Identity, job: Job = JOB, **changed: Any) -> Outcome:
    """Write what a worker leaves behind after a run."""
    folder = ledger.work_folder(job, 1)
    made = folder / RUN
    made.mkdir(parents=True)
    description = {**identity.description, "run_id": identity.run_id, "valid": True, **changed}
    (made / "run.json").write_text(json.dumps(description))
    (made / "job.json").write_text(json.dumps({"source": identity.source}))
    for name in ("runs.csv", "encounters.csv"):
        (made / name).write_text("x\n")
    return Outcome(job, folder)


def test_a_finished_run_is_not_missing_any_more(ledger: Ledger, identity: Identity) -> None:
    other = some_job(seed=2)
    assert ledger.missing([JOB, other]) == [JOB, other]
    assert ledger.keep(attempt(ledger, identity), identity) == ""
    assert ledger.missing([JOB, other]) == [other]
    ledger.verify([JOB, other], lambda job: identity)
    assert not ledger.work_folder(JOB, 1).exists()


def test_a_run_that_was_not_made_from_what_was_asked_for_is_not_kept(
    ledger: Ledger, identity: Identity, inputs: Inputs
) -> None:
    changed = identity_of(replace(inputs, step_s=0.2), "source")
    reason = ledger.keep(attempt(ledger, changed), identity)
    assert "step_s: 0.2 then, 0.1 now" in reason
    assert ledger.finished() == []


def test_every_kind_of_input_that_changed_is_named(inputs: Inputs, monkeypatch: pytest.MonkeyPatch) -> None:
    before = identity_of(inputs, "source")
    made: dict[str, Any] = {**before.description, "run_id": before.run_id}
    changes: dict[str, Inputs] = {
        "input file network has another content": replace(
            inputs, files={**inputs.files, "network": "0" * 64}
        ),
        "input file further.add.xml is new": replace(inputs, files={**inputs.files, "further.add.xml": "1"}),
        "parameter scenario.pedestrians_per_hour: 300.0 then, 9.0 now": replace(
            inputs, scenario_parameters={**inputs.scenario_parameters, "pedestrians_per_hour": 9.0}
        ),
        "parameter controller.gain: None then, 2 now": replace(inputs, controller_parameters={"gain": 2}),
        "egos: count: 4 then, 5 now": replace(inputs, egos={**inputs.egos, "count": 5}),
        "seed: 1 then, 2 now": replace(inputs, seed=2),
        "sensing: perfect then, onboard now": replace(inputs, sensing="onboard"),
    }
    for told, now in changes.items():
        assert differences(identity_of(now, "source"), made, "source") == [told]
    assert differences(before, made, "source") == []
    assert "source code" in differences(before, made, "another")[0]
    monkeypatch.setattr("cosim.recording.provenance.versions", lambda: {"numpy": "99"})
    told = "; ".join(differences(identity_of(inputs, "source"), made, "source"))
    assert "version of numpy: " in told
    assert "then, 99 now" in told


def test_changed_inputs_are_refused_with_the_run_and_the_change(
    ledger: Ledger, identity: Identity, inputs: Inputs
) -> None:
    ledger.keep(attempt(ledger, identity), identity)
    now = identity_of(replace(inputs, files={**inputs.files, "demand.rou.xml": "0"}), "source")
    with pytest.raises(InputError, match=rf"{JOB.name} was made .* demand\.rou\.xml has another content"):
        ledger.verify([JOB], lambda job: now)


def test_runs_of_another_study_are_not_mixed_in(ledger: Ledger, identity: Identity) -> None:
    ledger.keep(attempt(ledger, identity), identity)
    with pytest.raises(InputError, match=f"belongs to another study: 1 finished runs .* {JOB.name}"):
        ledger.missing([some_job(seed=5)])


def test_a_study_may_grow(ledger: Ledger, identity: Identity) -> None:
    ledger.keep(attempt(ledger, identity), identity)
    assert ledger.missing([JOB, some_job(seed=7)]) == [some_job(seed=7)]


@pytest.mark.parametrize("name", ["run.json", "job.json", "runs.csv", "encounters.csv"])
def test_a_run_that_has_lost_a_file_is_named(ledger: Ledger, identity: Identity, name: str) -> None:
    ledger.keep(attempt(ledger, identity), identity)
    (ledger.run_folder(JOB.name) / name).unlink()
    ledger.verify([JOB], lambda job: identity)
    assert f"{JOB.name}/{name}: is missing; remove the folder" in ledger.damaged[JOB.name]
    assert ledger.finished() == [JOB.name]
    assert ledger.whole() == []


def test_a_run_whose_description_was_cut_short_is_named(ledger: Ledger, identity: Identity) -> None:
    ledger.keep(attempt(ledger, identity), identity)
    (ledger.run_folder(JOB.name) / "run.json").write_text('{"run_id": ')
    ledger.verify([JOB], lambda job: identity)
    assert f"{JOB.name}: cannot be read" in ledger.damaged[JOB.name]


def test_a_note_that_is_no_object_is_named(ledger: Ledger, identity: Identity) -> None:
    ledger.keep(attempt(ledger, identity), identity)
    (ledger.run_folder(JOB.name) / "job.json").write_text("[]")
    ledger.verify([JOB], lambda job: identity)
    assert f"{JOB.name}: cannot be read (expected an object, found list)" in ledger.damaged[JOB.name]


def test_a_folder_with_other_files_and_a_file_are_refused_untouched(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("mine")
    with pytest.raises(InputError, match="has other files in it"):
        Ledger(tmp_path / "mine")
    with pytest.raises(InputError, match="this is a file"):
        Ledger(tmp_path / "mine" / "thesis.txt")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["thesis.txt"]


def test_a_folder_in_which_a_batch_only_just_began_is_taken_again(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / ".lock").touch()
    (tmp_path / "out" / "study.toml.part").write_text("scena")
    with Ledger(tmp_path / "out").opened(write_study(tmp_path)):
        pass


def test_a_study_that_has_lost_its_copy_of_the_study_file_goes_on(tmp_path: Path) -> None:
    study = write_study(tmp_path)
    with Ledger(tmp_path / "out").opened(study):
        pass
    (tmp_path / "out" / "study.toml").unlink()
    with Ledger(tmp_path / "out").opened(study):
        pass
    assert (tmp_path / "out" / "study.toml").read_text("utf-8") == study.read_text("utf-8")


def test_two_batches_do_not_work_in_one_folder(ledger: Ledger, tmp_path: Path) -> None:
    with (
        pytest.raises(InputError, match="another batch is at work"),
        Ledger(ledger.folder).opened(write_study(tmp_path)),
    ):
        pass


def test_remains_of_runs_in_flight_are_removed(tmp_path: Path) -> None:
    study = write_study(tmp_path)
    one = Ledger(tmp_path / "out")
    with one.opened(study):
        pass
    one.work_folder(JOB, 1).mkdir(parents=True)
    with one.opened(study):
        assert not one.work_folder(JOB, 1).exists()


def test_a_failure_is_kept_with_its_reason_and_log_until_the_run_succeeds(
    ledger: Ledger, identity: Identity
) -> None:
    folder = ledger.work_folder(JOB, 1)
    folder.mkdir(parents=True)
    (folder / LOG).write_text("".join(f"line {number}\n" for number in range(100)))
    ledger.keep_failure(Outcome(JOB, folder, "it broke"), attempts=2)
    ledger.write_failures()
    (row,) = rows(ledger.folder / "failed.csv")
    assert (row["run"], row["attempts"], row["reason"]) == (JOB.name, "2", "it broke")
    assert row["command"].startswith("cosim run midblock_zebra")
    (failure,) = ledger.failures()
    assert failure["last_lines"][-1] == "line 99"
    assert len(failure["last_lines"]) == 40
    ledger.keep(attempt(ledger, identity), identity)
    ledger.write_failures()
    assert rows(ledger.folder / "failed.csv") == []


def test_the_hash_of_the_source_is_of_what_makes_the_numbers_of_a_run_and_of_nothing_else() -> None:
    root = Path(identity_module.__file__).parents[2]
    files = {path.relative_to(root).as_posix() for path in identity_module._own_files("aeb")}
    deciding = (
        *(
            "cosim/step/plant.py",
            "cosim/sumo/world.py",
            "cosim/sensing/onboard_sensor.py",
            "cosim/running/compose.py",
        ),
        *("controllers/strategies/aeb.py", "controllers/safety/emergency_braking.py"),
        *("analysis/metrics/collision.py", "analysis/encounters/contacts.py", "sumo_scenarios/library.py"),
    )
    assert files.issuperset(deciding)
    others = ("controllers/strategies/vo_mpc.py", "analysis/statistics/paired.py", "cosim/cli/run.py")
    assert all((root / name).is_file() for name in others)
    assert files.isdisjoint(others)


def test_the_hash_of_the_source_knows_the_controller_in_use_and_no_other(tmp_path: Path) -> None:
    assert source_digest("sumo") != source_digest("aeb")
    assert source_digest("sumo") == source_digest.__wrapped__("sumo")
