"""Traffic lights of a replay, from rows written by hand."""

from __future__ import annotations

import numpy as np
import pandas as pd

from analysis.page.signals import crossing_signals, signal_ahead


def test_a_crossing_has_the_light_of_the_pedestrians_there_and_keeps_it_for_two_seconds() -> None:
    rows = pd.DataFrame(
        {
            "time_s": [0.0, 1.0, 1.0, 5.0],
            "crossing_id": ["a", "a", "b", "a"],
            "signal": ["red", "green", None, "red"],
        }
    )
    times = np.arange(0.0, 6.0)
    assert crossing_signals(rows, times) == {"a": [1, 0, 0, 0, None, 1]}
    assert crossing_signals(rows.drop(columns="signal"), times) == {}


def test_the_light_ahead_of_the_ego_has_a_state_and_a_place_or_nothing() -> None:
    rows = pd.DataFrame(
        {"signal_ahead": ["red", None], "signal_x_m": [1.234, np.nan], "signal_y_m": [5.0, np.nan]}
    )
    assert signal_ahead(rows) == {"state": ["red", None], "x_m": [1.23, None], "y_m": [5.0, None]}
    assert signal_ahead(rows.iloc[1:]) is None
    assert signal_ahead(pd.DataFrame({"time_s": [0.0]})) is None
