"""What is wrong with a study is found before its first run, SUMO's own objections included."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cosim.batches.matrix import build_matrix
from cosim.batches.pool import Pool
from cosim.batches.preflight import Checked, check
from cosim.batches.study import read_study
from cosim.batches.worker import Handling
from cosim.errors import InputError
from tests.cosim.batches.studies import write_study
from tests.cosim.cli.test_cli import network

pytestmark = [pytest.mark.sumo, pytest.mark.long]


@pytest.fixture(scope="module")
def pool() -> Iterator[Pool]:
    with Pool(1, Handling(60.0)) as one:
        yield one


def checked(pool: Pool, folder: Path, **keys: Any) -> Checked:
    file = write_study(folder, **keys)
    return check(build_matrix(read_study(file), file), pool, file)


def test_every_configuration_that_cannot_be_run_is_named(pool: Pool, tmp_path: Path) -> None:
    network(tmp_path)
    town: dict[str, Any] = {"scenarios": ["town.sumocfg"], "set": {}}
    wrong: list[tuple[dict[str, Any], list[str]]] = [
        ({"vary": {"pedestrians_per_hour": [200, -1]}}, ["pedestrians_per_hour=-1", "at least 0"]),
        ({"controllers": ["sumo", "aeb"], "set": {"friction": 0}}, ["aeb", "more than 0"]),
        ({"set": {"warmup_s": 60, "duration_s": 50}}, ["warmup_s=60", "duration_s=50"]),
        (town, ["town with sumo", "no ego"]),
        ({**town, "set": {"ego_route": "e1 apart"}}, ["town with sumo", "apart"]),
        ({**town, "vary": {"ego_route": ["e1 e2", "e9"]}}, ["ego_route=e9"]),
    ]
    for keys, words in wrong:
        with pytest.raises(InputError) as caught:
            checked(pool, tmp_path, **keys)
        text = str(caught.value)
        assert str(tmp_path / "study.toml") in text
        assert all(word in text for word in words), text


def test_sumo_itself_reads_each_road_once(pool: Pool, tmp_path: Path) -> None:
    network(tmp_path)
    (tmp_path / "bad.rou.xml").write_text('<routes><vehicle id="v" depart="soon"/></routes>')
    text = (tmp_path / "town.sumocfg").read_text()
    (tmp_path / "town.sumocfg").write_text(
        text.replace("</input>", '<route-files value="bad.rou.xml"/></input>')
    )
    with pytest.raises(InputError, match="SUMO cannot start"):
        checked(pool, tmp_path, scenarios=["town.sumocfg"], set={"ego_route": "e1 e2"})


def test_what_a_run_depends_on_is_known_before_it_is_made(pool: Pool, tmp_path: Path) -> None:
    file = write_study(tmp_path, controllers=["sumo", "aeb"], seeds="1-3")
    matrix = build_matrix(read_study(file), file)
    found = check(matrix, pool, file)
    identities = [found.identity(job).run_id for job in matrix.jobs()]
    assert len(set(identities)) == 6
    assert found.simulated_s(matrix.configurations[0]) == 6.0


def test_the_first_of_many_wrong_configurations_is_told_at_once(pool: Pool, tmp_path: Path) -> None:
    values = [-1.0, *range(1, 5000)]
    with pytest.raises(InputError, match=r"pedestrians_per_hour=-1\.0"):
        checked(pool, tmp_path, vary={"pedestrians_per_hour": values})
