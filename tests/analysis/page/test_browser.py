"""The page in a real browser, on real runs: the table, the replay, its frames, the keyboard, both modes."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from playwright.sync_api import Browser, BrowserContext, Page

from analysis.sealing import seal
from cosim.cli import main
from tests.analysis.page.criteria_files import write_criteria
from tests.browsers import started

CONTROLLERS = ("sumo", "vo_mpc")
SECONDS = ["--set", "warmup_s=30", "--set", "duration_s=70"]

pytestmark = [pytest.mark.sumo, pytest.mark.browser, pytest.mark.long]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return two runs with a report, a third one having lost its recording."""
    place = tmp_path_factory.mktemp("study")
    for name in CONTROLLERS:
        run = ["run", "midblock_zebra", "--controller", name, "--out", str(place / name), *SECONDS]
        assert main(run) == 0
    lost = ["run", "midblock_zebra", "--controller", "sumo", "--seed", "2", "--out", str(place / "lost")]
    assert main([*lost, *SECONDS]) == 0
    recordings = list((place / "lost").glob("*.parquet"))
    for path in recordings:
        path.unlink()
    seal(place / "lost", [], removed=recordings)  # as a batch does that keeps none
    stuck = {"metric": "deadlock", "run": "sumo", "ego_id": ego_of(place / "sumo"), "moment_s": 50.0}
    write_criteria(place, [stuck])
    assert main(["report", str(place)]) == 0
    return place


def ego_of(run: Path) -> str:
    """Return the ego that is on the road at 50 s."""
    rows = pq.read_table(run / "egos.parquet").to_pandas()
    return str(rows.loc[rows["time_s"].round(3) == 50.0, "ego_id"].iloc[0])


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with started() as one:
        yield one


def opened(context: BrowserContext, folder: Path, said: list[str]) -> Page:
    page = context.new_page()
    page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: said.append(f"error: {error}"))
    page.on("requestfailed", lambda request: said.append(f"failed: {request.url}"))
    page.on("request", lambda request: said.append(request.url) if request.url[:5] != "file:" else None)
    page.goto((folder / "report.html").as_uri())
    return page


@pytest.fixture
def page(browser: Browser, folder: Path) -> Iterator[Page]:
    """The open page; nothing may be said on the console, and nothing be loaded but files."""
    context = browser.new_context(reduced_motion="reduce", viewport={"width": 1280, "height": 900})
    said: list[str] = []
    yield opened(context, folder, said)
    context.close()
    assert said == []


def column(page: Page, number: int) -> list[str]:
    script = (
        "n => [...document.querySelectorAll('#encounter-table tbody tr')].filter(r => !r.hidden)"
        ".map(r => r.cells[n].dataset.v)"
    )
    return [str(text) for text in page.evaluate(script, number)]


def state(page: Page) -> dict[str, Any]:
    found: dict[str, Any] = page.evaluate("window.cosimReplay.state()")
    return found


def all_frames(page: Page) -> list[dict[str, Any]]:
    """Return the state of the open replay at each of its frames."""
    found: list[dict[str, Any]] = page.evaluate(
        "[...Array(window.cosimReplay.state().frames).keys()].map("
        "i => { window.cosimReplay.step(i - window.cosimReplay.state().index); "
        "return window.cosimReplay.state(); })"
    )
    return found


def replay(page: Page, controller: str) -> dict[str, Any]:
    """Open the first replay of a controller."""
    page.select_option("#filter-controller", controller)
    page.locator("tr:not([hidden]) button.open").first.click()
    page.wait_for_function("window.cosimReplay.state() !== null")
    return state(page)


def test_a_heading_sorts_both_ways_and_keeps_what_is_undefined_last(page: Page) -> None:
    heading = page.locator("#encounter-table th", has_text="Distance")
    button = heading.locator("button")
    assert heading.get_attribute("aria-sort") == "none"
    button.click()
    assert heading.get_attribute("aria-sort") == "ascending"
    values = [float(text) for text in column(page, 5)]
    assert values == sorted(values)
    assert len(set(values)) > 3
    button.press("Enter")
    assert heading.get_attribute("aria-sort") == "descending"
    assert [float(text) for text in column(page, 5)] == values[::-1]

    page.locator("#encounter-table th button", has_text="TTC").click()
    texts = column(page, 2)
    known = [float(text) for text in texts if text]
    assert 0 < len(known) < len(texts)
    assert texts[: len(known)] == [text for text in texts if text]
    assert known == sorted(known)
    assert page.locator("th[aria-sort=ascending], th[aria-sort=descending]").count() == 1


def test_filters_narrow_the_table_and_say_how_many_are_left(page: Page) -> None:
    everything = len(column(page, 7))
    page.select_option("#filter-controller", "vo_mpc")
    assert set(column(page, 7)) == {"vo_mpc"}
    left = len(column(page, 7))
    assert 0 < left < everything
    assert page.locator("#filter-count").inner_text() == f"{left} shown"
    page.fill("#filter-text", "no such pedestrian")
    assert column(page, 7) == []
    page.fill("#filter-text", "")
    page.select_option("#filter-controller", "")
    page.select_option("#filter-scenario", "midblock_zebra")
    assert len(column(page, 7)) == everything
    page.fill("#filter-text", "lost seed 2")
    assert set(column(page, 9)) == {"2"}


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_every_frame_shows_what_the_recorded_row_says(page: Page, folder: Path, controller: str) -> None:
    first = replay(page, controller)
    key = first["key"]
    egos = pq.read_table(folder / controller / "egos.parquet").to_pandas()
    others = pq.read_table(folder / controller / "neighbours.parquet").to_pandas()
    encounters = pd.read_csv(folder / controller / "encounters.csv")
    encounter = encounters.set_index("encounter_id").loc[int(key.rpartition("-")[2])]
    egos = egos[egos["ego_id"] == encounter["ego_id"]].set_index("time_s")
    met = others[others["object_id"] == encounter["ped_id"]].set_index("time_s")
    frames = all_frames(page)
    assert len(frames) > 30
    times = [frame["time_s"] for frame in frames]
    assert np.allclose(np.diff(times), 0.1, atol=1e-6)
    distances, seen = [], 0
    for frame in frames:
        row = egos.loc[frame["time_s"]]
        for name in ("front_x_m", "front_y_m", "heading_rad", "speed_mps", "acceleration_mps2"):
            assert frame["ego"][name] == pytest.approx(row[name], abs=5.1e-5)
        for name in ("rule", "manoeuvre", "because", "plan_status"):
            recorded = row[name]
            assert frame["ego"][name] == ("" if pd.isna(recorded) else recorded)
        assert frame["ego"]["solved"] == (None if pd.isna(row["solved"]) else int(row["solved"]))
        if frame["time_s"] in met.index:
            place = met.loc[frame["time_s"]]
            if frame["pedestrian"] is not None:
                seen += 1
                assert frame["pedestrian"]["x_m"] == pytest.approx(place["x_m"], abs=5.1e-5)
                assert frame["pedestrian"]["y_m"] == pytest.approx(place["y_m"], abs=5.1e-5)
        else:
            assert frame["pedestrian"] is None
        if frame["distance_m"] is not None:
            distances.append(frame["distance_m"])
            # The page's own geometry for the nearest one, from rounded rows.
            assert frame["nearest_m"] <= frame["distance_m"] + 5e-4
    assert seen > 20
    # Samples of the analysis lie between the recorded rows too.
    assert encounter["min_dist_m"] <= min(distances) + 1e-4
    assert min(distances) - encounter["min_dist_m"] < 0.1 * 15.0
    plans = [frame["plan_time_s"] for frame in frames]
    if controller == "sumo":
        assert set(plans) == {None}
    else:
        assert all(plan <= time + 1e-6 for plan, time in zip(plans, times, strict=True) if plan is not None)
        assert max(time - plan for plan, time in zip(plans, times, strict=True) if plan is not None) < 0.55


def test_an_old_plan_of_an_ego_that_plans_no_more_is_not_shown(page: Page) -> None:
    page.evaluate(
        "() => { const take = window.cosimReplayData; "
        "window.cosimReplayData = (key, data) => { data.plans.splice(1); take(key, data); }; }"
    )
    replay(page, "vo_mpc")
    frames = all_frames(page)
    (planned,) = {frame["plan_time_s"] for frame in frames} - {None}
    known = [(frame["time_s"] - planned, frame["plan_time_s"] is not None) for frame in frames]
    assert {shown for age, shown in known if 0.0 <= age < 0.95} == {True}
    assert {shown for age, shown in known if age > 1.05} == {False}


def test_the_replay_opens_at_the_worst_moment_and_says_what_it_shows(page: Page) -> None:
    shown = replay(page, "vo_mpc")
    row = page.locator(f"tr[data-key='{shown['key']}']")
    assert shown["time_s"] == pytest.approx(float(row.get_attribute("data-moment") or "nan"), abs=0.051)
    assert shown["playing"] is False  # the visitor wants no motion
    text = page.locator("#replay-summary").inner_text()
    assert f"At {shown['time_s']:.2f} s the ego drives {shown['ego']['speed_mps']:.1f} m/s" in text
    assert f"the nearest pedestrian is {shown['nearest_m']:.1f} m away" in text
    assert page.locator("#replay-summary").get_attribute("aria-live") == "polite"
    assert f"{shown['time_s']:.2f} s" in page.locator("#replay-readout").inner_text()
    painted = page.evaluate(
        "['replay-scene', 'replay-traces'].map(id => { const c = document.getElementById(id); "
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; "
        "return new Set(new Uint32Array(d.buffer)).size; })"
    )
    assert min(painted) > 20


def test_the_keyboard_steps_plays_jumps_and_closes(page: Page) -> None:
    page.select_option("#filter-controller", "vo_mpc")
    button = page.locator("tr:not([hidden]) button.open").first
    button.focus()
    page.keyboard.press("Enter")
    page.wait_for_function("window.cosimReplay.state() !== null")
    start = state(page)
    assert page.evaluate("document.activeElement.id") == "replay-play"
    page.keyboard.press("ArrowRight")
    assert state(page)["index"] == start["index"] + 1
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("ArrowLeft")
    assert state(page)["index"] == start["index"] - 1
    page.keyboard.press("End")
    assert state(page)["index"] == start["frames"] - 1
    page.keyboard.press("Home")
    assert state(page)["index"] == 0
    page.keyboard.press("+")
    assert state(page)["speed"] == 2
    page.keyboard.press("-")
    page.keyboard.press("-")
    assert state(page)["speed"] == 0.5
    page.keyboard.press("Space")
    assert state(page)["playing"] is True
    page.wait_for_function("window.cosimReplay.state().index > 3")
    page.keyboard.press("Space")
    assert state(page)["playing"] is False
    width = page.evaluate("getComputedStyle(document.activeElement).outlineWidth")
    assert float(width.removesuffix("px")) >= 2
    page.locator("#replay-scrub").focus()
    before = state(page)["index"]
    page.keyboard.press("ArrowRight")
    assert state(page)["index"] == before + 1
    page.keyboard.press("Escape")
    assert page.locator("#replay").get_attribute("open") is None
    assert page.evaluate("document.activeElement.className") == "open"


def test_playing_takes_as_long_as_the_recorded_time(page: Page) -> None:
    replay(page, "sumo")
    page.evaluate("window.cosimReplay.step(-10000)")
    first = state(page)["time_s"]
    passed = page.evaluate(
        "new Promise(done => { const start = performance.now(); window.cosimReplay.play(); "
        "setTimeout(() => { window.cosimReplay.pause(); done(performance.now() - start); }, 1500); })"
    )
    assert state(page)["time_s"] - first == pytest.approx(passed / 1000.0, abs=0.35)


def test_a_click_on_the_traces_moves_the_common_cursor(page: Page) -> None:
    shown = replay(page, "vo_mpc")
    box = page.locator("#replay-traces").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + box["width"] - 9, box["y"] + 50)
    assert state(page)["index"] == shown["frames"] - 1
    page.mouse.click(box["x"] + 9, box["y"] + 50)
    assert state(page)["index"] == 0
    page.click("#replay-moment")
    assert state(page)["time_s"] == shown["time_s"]


def test_a_link_opens_the_replay_and_next_goes_down_the_table(page: Page, folder: Path) -> None:
    key = replay(page, "vo_mpc")["key"]
    assert page.url.endswith(f"#replay={key}")
    page.goto("about:blank")
    page.goto((folder / "report.html").as_uri() + f"#replay={key}")
    page.wait_for_function("window.cosimReplay.state() !== null")
    assert state(page)["key"] == key
    keys = page.evaluate(
        "[...document.querySelectorAll('#encounter-table tbody tr')]"
        ".filter(r => r.querySelector('button.open')).map(r => r.dataset.key)"
    )
    following = keys[keys.index(key) + 1]
    page.click("#replay-next")
    page.wait_for_function("key => window.cosimReplay.state().key === key", arg=following)


def test_a_verdict_on_an_ego_that_met_nobody_opens_its_moment(page: Page) -> None:
    link = page.locator("#criteria a.open-moment")
    key = link.get_attribute("data-key")
    link.click()
    page.wait_for_function("key => window.cosimReplay.state()?.key === key", arg=key)
    assert state(page)["time_s"] == pytest.approx(50.0)
    assert state(page)["pedestrian"] is None
    assert page.locator("#replay-title").inner_text().endswith("at 50.0 s")
    assert page.locator("#replay-next").is_disabled()
    page.keyboard.press("Escape")
    assert page.evaluate("document.activeElement.className") == "open-moment"


def test_no_recording_leads_to_the_command_that_records_it(page: Page) -> None:
    page.fill("#filter-text", "lost")
    row = page.locator("tr:not([hidden])", has=page.locator("button.how")).first
    row.locator("button.how").click()
    text = page.locator(":focus").inner_text()
    assert "cosim run midblock_zebra --controller sumo --seed 2" in text
    assert "duration_s=70" in text


def test_missing_data_beside_the_page_is_told(browser: Browser, folder: Path, tmp_path: Path) -> None:
    shutil.copy(folder / "report.html", tmp_path)
    context = browser.new_context(reduced_motion="reduce")
    page = opened(context, tmp_path, [])
    page.locator("button.open").first.click()
    page.wait_for_selector("#replay-problem:not([hidden])")
    text = page.locator("#replay-problem").inner_text()
    assert "report_data/replays/" in text
    assert "Run cosim report to write it again" in text
    context.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out_from_its_ground_in_both_modes(browser: Browser, folder: Path, scheme: Any) -> None:
    """Contrast of at least 4.5, that of WCAG 2 level AA, for every text; figures included."""
    context = browser.new_context(color_scheme=scheme, reduced_motion="reduce")
    page = opened(context, folder, [])
    found = page.evaluate(CONTRASTS)
    context.close()
    assert len(found) > 100
    assert {json.dumps(one) for one in found if one["contrast"] < 4.5} == set()


CONTRASTS = """() => {
  const channels = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
  const light = (rgb) => {
    const [r, g, b] = rgb.slice(0, 3).map((v) => {
      const s = v / 255;
      return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (node) => {
    for (let one = node; one; one = one.parentElement) {
      const rgb = channels(getComputedStyle(one).backgroundColor);
      if (rgb.length === 3 || rgb[3] > 0.99) return rgb;
    }
    return [255, 255, 255];
  };
  const found = [];
  for (const node of document.querySelectorAll("body *")) {
    const own = [...node.childNodes].some((child) => child.nodeType === 3 && child.textContent.trim());
    if (!own || !node.checkVisibility() || node.closest("script")) continue;
    const style = getComputedStyle(node);
    const ink = node.namespaceURI.endsWith("svg") ? style.fill : style.color;
    const [a, b] = [light(channels(ink)), light(ground(node))].sort((x, y) => y - x);
    found.push({ text: node.textContent.trim().slice(0, 30), ink, contrast: (a + 0.05) / (b + 0.05) });
  }
  return found;
}"""


def test_on_a_telephone_tables_scroll_inside_and_their_first_column_stays(page: Page) -> None:
    page.set_viewport_size({"width": 400, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") == 400
    table = page.locator("#configurations .scroll").first
    name = table.locator("tbody th").first
    before = name.bounding_box()
    table.evaluate("one => { one.scrollLeft = 200; }")
    assert table.evaluate("one => one.scrollLeft") > 50
    after = name.bounding_box()
    assert before is not None
    assert after is not None
    assert after["x"] == pytest.approx(before["x"], abs=1.0)
    assert after["width"] < 200.0
