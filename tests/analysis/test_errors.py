"""What the messages of errors share."""

from collections.abc import Callable, Iterable

import pytest

from analysis import errors
from sumo_scenarios import errors as scenario_errors


@pytest.mark.parametrize("did_you_mean", [errors.did_you_mean, scenario_errors.did_you_mean])
def test_a_wrong_name_is_answered_by_the_nearest_one_if_one_is_near(
    did_you_mean: Callable[[str, Iterable[str]], str],
) -> None:
    assert did_you_mean("horizn", ["solver", "horizon"]) == "did you mean 'horizon'? "
    assert did_you_mean("xyz", ["solver", "horizon"]) == ""
