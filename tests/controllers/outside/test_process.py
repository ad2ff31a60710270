"""A program as a controller: the protocol, its schema, and everything that a program can do wrong."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

import cosim
from controllers import catalog
from controllers.interface import Manoeuvre, Plan
from controllers.outside.process import messages
from controllers.outside.process.driver import LATE, ProcessController
from controllers.outside.process.link import LinkError
from controllers.outside.process.telling import told
from tests.controllers.scenes import golden, perception
from tests.documentation.command_blocks import ROOT

PROGRAM = Path(__file__).with_name("program.py")
SCENE = golden()["pedestrian crosses"]


def address(behaviour: str) -> str:
    return f"process:{sys.executable} {PROGRAM} {behaviour}"


@pytest.fixture
def build() -> Iterator[Callable[..., ProcessController]]:
    """Build controllers, and end their programs however the test ends."""
    every: list[ProcessController] = []

    def made(behaviour: str, **values: Any) -> ProcessController:
        one = catalog.build(address(behaviour), **{"deadline_ms": 5000.0, **values})
        assert isinstance(one, ProcessController)
        every.append(one)
        return one

    yield made
    for one in every:
        one.close()


def ask(controller: ProcessController) -> Plan:
    return controller.plan(SCENE, controller.decide(SCENE))


def fails(controller: ProcessController) -> str:
    with pytest.raises(LinkError) as caught:
        [ask(controller) for _ in range(6)]
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("behaviour", ["good", "packed"])
def test_an_acceleration_alone_keeps_the_lane(
    behaviour: str, build: Callable[..., ProcessController]
) -> None:
    plan = ask(build(behaviour))
    assert plan.solved
    assert set(plan.command.acceleration) == {-1.0}
    assert len(plan.command.times) > 1


def test_a_program_may_steer_over_time(build: Callable[..., ProcessController]) -> None:
    command = ask(build("steers")).command
    np.testing.assert_array_equal(command.times, [0.0, 0.05])
    np.testing.assert_array_equal(command.acceleration, [1.0, 0.0])
    np.testing.assert_array_equal(command.steering, [0.1, 0.2])


def test_a_late_answer_is_the_fallback_and_is_thrown_away(build: Callable[..., ProcessController]) -> None:
    one = build("late", deadline_ms=100.0, fallback_braking_mps2=2.5)
    assert ask(one).status == "ok"
    late = ask(one)
    assert (late.solved, late.status) == (False, LATE)
    assert set(late.command.acceleration) == {-2.5}
    time.sleep(0.5)
    assert ask(one).status == "ok"  # the answer to step 2, which is there by now, is not taken for it


def test_answers_to_earlier_steps_do_not_put_off_the_deadline(
    build: Callable[..., ProcessController],
) -> None:
    one = build("trickles", deadline_ms=300.0)
    assert [ask(one).status for _ in range(4)][2:] == ["ok", LATE]


@pytest.mark.long
def test_a_program_that_hangs_is_given_up_after_the_patience(build: Callable[..., ProcessController]) -> None:
    one = build("hangs", deadline_ms=100.0, patience_s=0.25)
    begun = time.monotonic()
    assert "has not answered for 0.3 s" in fails(one)
    assert time.monotonic() - begun < 3.0


@pytest.mark.parametrize(
    ("behaviour", "said"),
    [
        ("dies", "ended with exit code 7"),
        ("rubbish", "is no message: expected four bytes"),
        ("nan", "sent a wrong command: acceleration_mps2"),
        ("lists", "acceleration_mps2: 2 values for 1 times"),
        ("lane", "target_lane 9: there are 0, 1, 2"),
    ],
)
def test_what_a_program_does_wrong_is_one_line(
    behaviour: str, said: str, build: Callable[..., ProcessController]
) -> None:
    assert said in fails(build(behaviour))


@pytest.mark.long
@pytest.mark.parametrize(
    ("behaviour", "said"),
    [
        ("old", "speaks version 0 of the step protocol; expected 1"),
        ("stranger", "did not send the token"),
        ("ends", "ended with exit code 5"),
        ("silent", "did not connect to COSIM_ADDRESS within 0.5 s"),
    ],
)
def test_what_does_not_even_begin_is_told_before_the_run(behaviour: str, said: str) -> None:
    timeout = 0.5 if behaviour == "silent" else 10.0
    with pytest.raises(catalog.CatalogError, match=said) as caught:
        catalog.build(address(behaviour), start_timeout_s=timeout)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "said"), [("process:./no_such", "No such file"), ("process:", "expected a")]
)
def test_a_program_that_is_not_there_is_one_line(name: str, said: str) -> None:
    with pytest.raises(catalog.CatalogError, match=said):
        catalog.build(name)


@pytest.mark.long
@pytest.mark.parametrize("behaviour", ["good", "stays"])
def test_no_program_outlives_its_controller(behaviour: str, build: Callable[..., ProcessController]) -> None:
    one = build(behaviour)
    ask(one)
    process = one._link._process
    one.close()
    one.close()
    assert process.poll() is not None


def test_without_msgpack_the_command_is_told(
    build: Callable[..., ProcessController], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "msgpack", None)
    with pytest.raises(catalog.CatalogError, match=r"pip install msgpack"):
        build("packed")


@pytest.mark.long
def test_every_message_fits_the_published_schema() -> None:
    schema = messages.schema()
    for scene in golden().values():
        message = told(scene, 3)
        jsonschema.validate(message, schema)
        messages.Perception.model_validate(message)  # names each field: a forgotten one fails
    jsonschema.validate({"type": "command", "step": 1, "acceleration_mps2": 0.0}, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"type": "command", "step": 1, "acceleration_mps2": "fast"}, schema)


def test_the_published_schema_is_of_the_code() -> None:
    path = ROOT / "docs/schemas/step-protocol-1.json"
    assert path.read_text("utf-8") == messages.schema_text()


def test_a_manoeuvre_is_handed_on() -> None:
    from controllers.outside.process.telling import decision_of, plan_of

    answer = messages.Command(
        type="command", step=1, acceleration_mps2=0.0, manoeuvre="hand_back", because="person0"
    )
    decision = decision_of(answer, perception())
    assert (decision.manoeuvre, decision.because) == (Manoeuvre.HAND_BACK, "person0")
    assert plan_of(answer, perception(), decision).command.hand_back


@pytest.mark.sumo
@pytest.mark.parametrize("behaviour", ["good", "dies"])
def test_a_run_with_a_program_is_marked_if_it_dies(behaviour: str, tmp_path: Path) -> None:
    ran = cosim.run(
        "midblock_zebra",
        controller=address(behaviour),
        out=tmp_path / "run",
        duration_s=8.0,
        warmup_s=5.0,
        deadline_ms=5000.0,
    )
    assert ran.valid == (behaviour == "good")
    assert ("ended with exit code 7" in ran.invalid_reason) == (behaviour == "dies")
    assert len(ran.egos) > 0
    assert list(ran.description["controller_files"]) == [Path(sys.executable).name, PROGRAM.name]
    running = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
    assert f"{PROGRAM} {behaviour}" not in running
    assert os.listdir(tmp_path) == ["run"]
