"""Figures of a run whose numbers can be derived by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.encounters.case import Case, prepare
from analysis.plots.figures import draw_figures
from analysis.plots.plane import draw_plane
from analysis.plots.scene import SceneError, choose
from analysis.plots.space_time import draw_space_time
from analysis.plots.traces import draw_traces
from analysis.recording.reading import read_run
from analysis.results.analyse import analyse_run
from tests.analysis.recorded import Ego, Person, line, write_run


def meeting(folder: Path) -> Case:
    """A person crosses at x = 32.5 m and is off the road before a car at 5 m/s comes; another ego is far."""
    write_run(
        folder,
        [Ego(line(0.0, 0.0, 5.0, 0.0)), Ego(line(0.0, 900.0, 10.0, 0.0), name="far/away")],
        [Person(line(32.5, -5.0, 0.0, 1.25))],
    )
    return prepare(read_run(folder))


def labelled(figure: Figure) -> list[str]:
    """Return the labels of all axes that have one."""
    return [text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel()) if text]


def drawn(axes: Axes, label: str) -> np.ndarray:
    """Return the points of the line with that label."""
    (found,) = [one for one in axes.lines if one.get_label() == label]
    points: np.ndarray = found.get_xydata()  # type: ignore[assignment]  # it has data
    return points


def test_the_traces_show_what_was_recorded(tmp_path: Path) -> None:
    speed, acceleration, heading, ttc = draw_traces(choose(meeting(tmp_path / "run"), "ego", None)).axes
    points = drawn(speed, "ego")
    assert points[:, 1] == pytest.approx(5.0)
    assert (points[0, 0], points[-1, 0]) == (0.0, 10.0)
    assert drawn(speed, "limit")[:, 1] == pytest.approx(13.89)
    for axes in (acceleration, heading):
        assert axes.lines[0].get_ydata() == pytest.approx(0.0)
    assert ttc.get_ylabel() == "TTC [s]"


def test_the_least_ttc_drawn_is_the_one_of_the_table(tmp_path: Path) -> None:
    folder = write_run(
        tmp_path / "run", [Ego(line(0.0, 0.0, 5.0, 0.0))], [Person(line(32.5, -5.0, 0.0, 0.9))]
    )
    (row,) = analyse_run(folder).encounters
    ((name, time, values),) = choose(prepare(read_run(folder)), None, 1).ttc()
    assert name == "ped"
    assert np.isfinite(values).any()
    assert np.nanmin(values) == pytest.approx(row["min_ttc_s"])
    assert time[np.nanargmin(values)] == pytest.approx(row["t_min_ttc_s"])


def test_the_space_time_diagram_has_the_pedestrian_where_they_cross_the_way(tmp_path: Path) -> None:
    (axes,) = draw_space_time(choose(meeting(tmp_path / "run"), None, 1)).axes
    bold = drawn(axes, "pedestrian in the ego's path")
    inside = bold[np.isfinite(bold[:, 1])]
    # The disc is within the body's width while |y| <= 0.9 m + 0.25 m, at 1.25 m/s.
    assert inside[0, 0] == pytest.approx((5.0 - 1.15) / 1.25, abs=0.05)
    assert inside[-1, 0] == pytest.approx((5.0 + 1.15) / 1.25, abs=0.05)
    front = drawn(axes, "ego, front to rear")
    start = front[0, 0] * 5.0  # where the ego's centre is when the encounter begins
    assert inside[:, 1] == pytest.approx(32.5 - start)
    assert front[:, 1] == pytest.approx(5.0 * (front[:, 0] - front[0, 0]) + 2.25)


def test_the_plane_shows_both_ways_in_world_coordinates(tmp_path: Path) -> None:
    (axes,) = draw_plane(choose(meeting(tmp_path / "run"), None, 1)).axes
    ego, person = drawn(axes, "ego"), drawn(axes, "pedestrian")
    assert ego[:, 1] == pytest.approx(0.0, abs=1e-9)
    assert person[:, 0] == pytest.approx(32.5)
    assert np.diff(person[:, 1]).min() > 0.0
    (low, high) = axes.get_xlim()
    assert low < ego[:, 0].min() < ego[:, 0].max() < high


def test_every_axis_has_a_unit_or_shares_one(tmp_path: Path) -> None:
    scene = choose(meeting(tmp_path / "run"), None, None)
    for draw, count in ((draw_plane, 2), (draw_traces, 5), (draw_space_time, 2)):
        texts = labelled(draw(scene))
        assert len(texts) == count
        assert all("[" in text and "]" in text for text in texts), texts


@pytest.mark.long
@pytest.mark.parametrize("kind", ["png", "svg"])
def test_the_same_run_gives_the_same_bytes(tmp_path: Path, kind: str) -> None:
    case = meeting(tmp_path / "run")
    first = draw_figures(choose(case, None, 1), tmp_path / "one", kind)
    again = draw_figures(choose(prepare(read_run(tmp_path / "run")), None, 1), tmp_path / "two", kind)
    assert [path.name for path in first] == [
        f"encounter-1-{name}.{kind}" for name in ("plane", "traces", "space-time")
    ]
    for one, two in zip(first, again, strict=True):
        assert one.read_bytes() == two.read_bytes()
        assert str(tmp_path).encode() not in one.read_bytes()


@pytest.mark.long
def test_a_name_with_a_slash_makes_no_folder_and_an_ego_that_meets_nobody_is_drawn(tmp_path: Path) -> None:
    files = draw_figures(choose(meeting(tmp_path / "run"), "far/away", None), tmp_path / "out", "svg")
    assert [path.parent for path in files] == [tmp_path / "out"] * 3
    assert files[0].name == "far_away-plane.svg"
    assert "no collision course" in files[1].read_text()


def test_who_does_not_exist_is_answered_by_who_does(tmp_path: Path) -> None:
    case = meeting(tmp_path / "run")
    with pytest.raises(SceneError, match=r"no ego 'nobody' .* ego, far/away"):
        choose(case, "nobody", None)
    with pytest.raises(SceneError, match=r"no encounter 2 .* 1 to 1"):
        choose(case, None, 2)
    with pytest.raises(SceneError, match="no encounter 0"):
        choose(case, None, 0)
    with pytest.raises(SceneError, match="one of ego 'ego', not of 'far/away'"):
        choose(case, "far/away", 1)
