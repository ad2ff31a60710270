"""The page on A4: nothing is cut off, and what is not printed is counted."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page

from analysis.page.report import PRINTED, write_report
from cosim.presentation.wording import sentence
from tests.analysis.page.criteria_files import write_criteria
from tests.analysis.study.study_folders import write_study_run
from tests.browsers import started

pytestmark = [pytest.mark.browser, pytest.mark.long]
CONTROLLERS = ("sumo", "vo_mpc", "drivable_area", "potential_field", "careful_driver", "pred_mpc_direction")
CRITERIA = PRINTED["criteria"] + 17
EACH = 9

OVERFLOWING = """() => [...document.querySelectorAll('main *, header *')].filter((one) => {
  const box = one.getBoundingClientRect();
  return box.width > 0 && !one.closest('svg') && box.right > document.documentElement.clientWidth + 1;
}).map((one) => one.tagName + '.' + one.className)"""
VISIBLE = (
    "id => [...document.querySelectorAll(id + ' tbody tr')].filter((one) => one.checkVisibility()).length"
)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """Return the report of a large check, as it is printed."""
    folder: Path = tmp_path_factory.mktemp("large")
    for name in CONTROLLERS:
        met = [{"min_ttc_s": 1.0 + 0.1 * number, "severity": "slight"} for number in range(EACH)]
        write_study_run(folder / name, name, 1, encounters=met, numbers={"ego_delay_mean_s": 5.0})
    write_criteria(folder, [{"criterion_id": f"criterion {number}"} for number in range(CRITERIA)])
    write_report([folder], folder, sentence)
    with started() as browser:
        page = browser.new_page(viewport={"width": 703, "height": 1000})  # A4 without margins, 96 to the inch
        page.goto((folder / "report.html").as_uri())
        page.emulate_media(media="print")
        yield page


def before_print(page: Page) -> None:
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")


def test_nothing_is_cut_off_and_every_section_begins_a_page(page: Page) -> None:
    before_print(page)
    assert page.evaluate(OVERFLOWING) == []
    assert page.locator("nav").is_hidden()
    assert page.locator("#distributions svg").count() >= 6  # figures are lines, not pixels
    breaks = page.evaluate(
        "[...document.querySelectorAll('main > section')].map((one) => getComputedStyle(one).breakBefore)"
    )
    assert breaks.count("page") >= len(breaks) - 2
    printed = page.pdf(prefer_css_page_size=True, print_background=True)
    assert 4 <= len(re.findall(rb"/Type /Page\b(?!s)", printed)) <= 20


def test_what_is_not_printed_is_counted_below_the_table(page: Page) -> None:
    before_print(page)
    assert page.evaluate(VISIBLE, "#criteria") == PRINTED["criteria"]
    assert page.evaluate(VISIBLE, "#encounter-table") == PRINTED["encounters"]
    left, total = EACH * len(CONTROLLERS) - PRINTED["encounters"], EACH * len(CONTROLLERS)
    notes = [one.inner_text() for one in page.locator(".print-note").all() if one.is_visible()]
    assert notes[0] == "17 of 57 rows are not printed; all are in criteria.csv."
    assert notes[1].startswith(f"{left} of {total} encounters are not printed; all are in encounters.csv")
    assert notes[2].startswith("Not printed: the 6 runs with the command of each")


def test_a_filtered_table_prints_what_it_shows_and_counts_the_others(page: Page) -> None:
    page.evaluate(
        "document.getElementById('filter-controller').value = 'sumo';"
        "document.getElementById('filter-controller').dispatchEvent(new Event('input'))"
    )
    before_print(page)
    assert page.evaluate(VISIBLE, "#encounter-table") == EACH
    assert page.locator("#encounters-left-out").inner_text().startswith(f"45 of {EACH * len(CONTROLLERS)} ")
