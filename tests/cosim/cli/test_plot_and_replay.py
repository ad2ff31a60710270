"""``cosim plot`` and ``cosim replay``: files that show the recorded run, and one line where that cannot be."""

from __future__ import annotations

import importlib.util
from importlib.machinery import ModuleSpec
from pathlib import Path

import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from matplotlib.collections import Collection
from PIL import Image

from analysis.encounters.case import prepare
from analysis.plots import animation
from analysis.plots.animation import Film, frame_indices
from analysis.plots.scene import choose
from analysis.recording.reading import read_run
from analysis.sealing import seal_recording
from cosim.cli import main
from tests.analysis.recorded import Ego, Person, Vehicle, line, write_run
from tests.cosim.cli.test_cli import refused


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def one_encounter(folder: Path, duration: float, step: float = 0.1) -> Path:
    """Write a run with one encounter and return its folder."""
    write_run(
        folder,
        [Ego(line(0.0, 0.0, 5.0, 0.0))],
        [Person(line(32.5, -5.0, 0.0, 0.9))],
        [Vehicle(line(20.0, 3.0, 5.0, 0.0))],
        duration=duration,
        step=step,
    )
    seal_recording(folder)
    return folder


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """A short run with one encounter."""
    return one_encounter(tmp_path / "run", 2.0)


@pytest.mark.long
def test_figures_go_into_the_run_s_folder_or_a_new_one(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plot", "run"]) == 0
    assert capsys.readouterr().out.split() == [
        f"run/plots/ego-{name}.png" for name in ("plane", "traces", "space-time")
    ]
    assert main(["plot", "run"]) == 0  # the same figures again
    assert main(["plot", "run", "--encounter", "1", "--format", "svg", "--out", "figures"]) == 0
    assert len(list(Path("figures").glob("encounter-1-*.svg"))) == 3
    with Image.open("run/plots/ego-traces.png") as picture:
        assert picture.width > 1000
    assert "has files in it" in refused(capsys, "plot", "run", "--out", "figures")


def test_what_cannot_be_drawn_is_one_line(recorded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "there are: ego" in refused(capsys, "plot", "run", "--ego", "nobody")
    assert "there are: 1 to 1" in refused(capsys, "plot", "run", "--encounter", "7")
    assert "expected png or svg" in refused(capsys, "plot", "run", "--format", "pdf")
    assert "no such run folder" in refused(capsys, "plot", "gone")
    assert "there are: 1 to 1" in refused(capsys, "replay", "run", "--encounter", "2", "--out", "a.gif")
    assert ".gif or .mp4" in refused(capsys, "replay", "run", "--encounter", "1", "--out", "a.avi")
    assert "does not exist" in refused(capsys, "replay", "run", "--encounter", "1", "--out", "b/a.gif")
    (recorded / "plans.parquet").write_bytes(b"PAR1")
    assert "plans.parquet: was altered" in refused(
        capsys, "replay", "run", "--encounter", "1", "--out", "a.gif"
    )
    assert not Path("a.gif").exists()


def test_without_matplotlib_one_line_says_what_to_install(
    recorded: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    find = importlib.util.find_spec

    def without(name: str, package: str | None = None) -> ModuleSpec | None:
        return None if name == "matplotlib" else find(name, package)

    monkeypatch.setattr(importlib.util, "find_spec", without)
    for arguments in (["plot", "run"], ["replay", "run", "--encounter", "1", "--out", "a.gif"]):
        line = refused(capsys, *arguments)
        assert f"cosim {arguments[0]} needs matplotlib: pip install matplotlib" in line


@pytest.mark.long
def test_a_film_has_a_frame_for_every_recorded_instant_and_the_same_bytes_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recorded = one_encounter(tmp_path / "brief", 0.8)
    monkeypatch.setattr("analysis.plots.animation.DOTS_PER_INCH", 20)
    for name in ("one.gif", "two.gif"):
        assert main(["replay", "brief", "--encounter", "1", "--out", name]) == 0
    assert Path("one.gif").read_bytes() == Path("two.gif").read_bytes()
    scene = choose(prepare(read_run(recorded)), None, 1)
    with Image.open("one.gif") as film:
        assert film.n_frames == len(frame_indices(scene)) == 9  # type: ignore[attr-defined]  # a GIF has it
        assert film.info["duration"] == 100  # ms, as long as a recorded step


@pytest.mark.parametrize(("step", "duration_ms"), [(0.3, 300), (0.4, 400), (0.15, 150), (0.033, 100)])
def test_a_second_of_film_is_a_second_of_the_run_for_every_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: float, duration_ms: int
) -> None:
    """A GIF counts hundredths of a second; three steps of 0.033 s are 0.099 s."""
    one_encounter(tmp_path / "brief", 4 * step, step)
    monkeypatch.setattr("analysis.plots.animation.DOTS_PER_INCH", 20)
    assert main(["replay", "brief", "--encounter", "1", "--out", "a.gif"]) == 0
    with Image.open("a.gif") as film:
        assert film.info["duration"] == duration_ms


@pytest.mark.parametrize(("step", "rate"), [(0.1, 10.0), (0.3, 10 / 3), (0.4, 2.5)])
def test_a_film_with_ffmpeg_has_the_rate_of_the_recording(step: float, rate: float) -> None:
    writer = animation.writer_for(Path("a.mp4"), step)
    assert isinstance(writer, FFMpegWriter)
    assert writer.fps == pytest.approx(rate)


def outline(bodies: Collection) -> np.ndarray:
    """Return the four corners of the only body in a collection."""
    (path,) = bodies.get_paths()
    return np.asarray(path.vertices)[:-1]


@pytest.mark.parametrize("instant", [0, 10, 20])
def test_a_frame_shows_everybody_where_the_recorded_row_says(recorded: Path, instant: int) -> None:
    scene = choose(prepare(read_run(recorded)), None, 1)
    film = Film(scene)
    index = frame_indices(scene)[instant]
    film.show(index)
    time = float(scene.case.grid.time[index])
    vehicles, ego, _, met = film._moving
    body = outline(ego)
    assert body.mean(axis=0) == pytest.approx([5.0 * time, 0.0], abs=1e-6)
    assert np.ptp(body, axis=0) == pytest.approx([4.5, 1.8])
    assert outline(vehicles).mean(axis=0) == pytest.approx([20.0 + 5.0 * time, 3.0], abs=1e-6)
    assert np.asarray(met.get_offsets()) == pytest.approx(np.array([[32.5, -5.0 + 0.9 * time]]), abs=1e-6)
    assert f"{time:.1f} s, 5.0 m/s" in film.axes.get_title(loc="left")


@pytest.mark.skipif(animation.has_ffmpeg(), reason="ffmpeg is installed here")
def test_without_ffmpeg_one_line_says_so(recorded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "needs ffmpeg" in refused(capsys, "replay", "run", "--encounter", "1", "--out", "a.mp4")


@pytest.mark.skipif(not animation.has_ffmpeg(), reason="ffmpeg is not installed")
def test_with_ffmpeg_there_is_a_film(recorded: Path) -> None:
    assert main(["replay", "run", "--encounter", "1", "--out", "a.mp4"]) == 0
    assert b"ftyp" in Path("a.mp4").read_bytes()[:16]


@pytest.mark.long
@pytest.mark.sumo
def test_a_run_in_sumo_is_drawn_with_its_plans(tmp_path: Path) -> None:
    run = ["run", "midblock_zebra", "--controller", "vo_mpc", "--set", "warmup_s=10", "--duration-s", "20"]
    assert main([*run, "--set", "pedestrians_per_hour=1200", "--out", "real"]) == 0
    assert main(["plot", "real", "--encounter", "1"]) == 0
    scene = choose(prepare(read_run(tmp_path / "real")), None, 1)
    film = Film(scene)
    index = frame_indices(scene)[-1]
    film.show(index)
    plan = film.plan_at(float(scene.case.grid.time[index]))
    assert plan is not None
    # The plan begins where the ego is: its rear axle is behind the centre.
    track = next(track for track in scene.case.egos if track.name == scene.ego)
    centre = np.array([track.x[index - track.first], track.y[index - track.first]])
    nearest = np.hypot(*(plan.points - centre).T).min()
    assert nearest < 8.0
    assert len(film._plan_line.get_xydata()) == len(plan.points)  # type: ignore[arg-type]
