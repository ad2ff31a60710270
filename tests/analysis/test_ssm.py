"""SUMO's SSM device as a judge, and the reading of its output."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analysis.errors import AnalysisError
from tests.analysis import proxy
from tests.analysis.ssm import read_ssm


@pytest.fixture(scope="module")
def net(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return proxy.build(tmp_path_factory.mktemp("net"))


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.parametrize("foes", [proxy.PET_FOES, proxy.WIDE_FOES], ids=["pedestrian", "vehicle"])
def test_sumo_agrees_on_the_post_encroachment_time(tmp_path: Path, net: Path, foes: list[proxy.Foe]) -> None:
    differences = np.array(proxy.post_encroachment_differences(tmp_path, net, foes))
    assert np.abs(differences).max() <= 0.02


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.parametrize("foe", [proxy.COURSE, proxy.SIDE, proxy.LEADER], ids=["front", "side", "following"])
def test_sumo_agrees_on_the_time_to_collision(tmp_path: Path, net: Path, foe: proxy.Foe) -> None:
    assert np.abs(proxy.time_to_collision_differences(tmp_path, net, foe)).max() <= 0.02


def test_undefined_measures_are_absent(tmp_path: Path) -> None:
    path = tmp_path / "ssm.xml"
    path.write_text(
        '<SSMLog><conflict begin="1.0" end="3.0" ego="a" foe="b"><timeSpan values="1 2"/>'
        '<TTCSpan values="NA 1.5"/><minTTC time="NA" position="NA" type="NA" value="NA" speed="NA"/>'
        '<PET time="2.0" position="0,0" type="17" value="0.40" speed="3.0"/></conflict></SSMLog>'
    )
    (conflict,) = read_ssm(path)
    assert conflict.min_ttc is None
    assert conflict.max_drac is None
    assert conflict.pet is not None
    assert conflict.pet.value == 0.4
    assert np.array_equal(conflict.ttc, [np.nan, 1.5], equal_nan=True)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<SSMLog><conflict", "truncated or not XML"),
        ("<routes/>", "expected an SSMLog, found 'routes'"),
        ('<SSMLog><conflict begin="1" end="2" ego="a"/></SSMLog>', "no attribute 'foe'"),
        ('<SSMLog><conflict begin="soon" end="2" ego="a" foe="b"/></SSMLog>', "conflict 1"),
    ],
)
def test_a_broken_output_is_refused_with_one_line(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "ssm.xml"
    path.write_text(text)
    with pytest.raises(AnalysisError, match=says):
        read_ssm(path)


def test_a_missing_output_is_named(tmp_path: Path) -> None:
    with pytest.raises(AnalysisError, match="nowhere"):
        read_ssm(tmp_path / "nowhere.xml")
