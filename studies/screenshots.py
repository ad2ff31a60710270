"""``make screenshots``: pictures of a report and of a replay.

``python -m studies.screenshots STUDY_DIR OUT_DIR`` takes them from a finished study. Like the tests of the
page, it needs Playwright and Chromium.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
CONTROLLER = "vo_mpc"
"""Controller whose encounter with the smallest TTC is replayed."""
WIDTH, HEIGHT = 1280, 860


def main(study: Path, out: Path) -> int:
    """Write a study's report and its pictures ``report.png`` and ``replay.png``; return the exit code."""
    from cosim.errors import CosimError
    from cosim.presentation.page import write_page

    browser = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if browser is None:
        print(f"screenshots: no browser found: one of {', '.join(BROWSERS)} expected", file=sys.stderr)
        return 2
    try:
        page, *_ = write_page([study])
    except CosimError as error:
        print(f"screenshots: {error}", file=sys.stderr)
        return 2
    out.mkdir(parents=True, exist_ok=True)
    for path in take(page, out, browser):
        print(path)
    return 0


def take(report: Path, out: Path, browser: str) -> list[Path]:
    """Take both pictures, reproducibly, and return their paths."""
    from playwright.sync_api import sync_playwright

    paths = [out / "report.png", out / "replay.png"]
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox"])
        page = started.new_page(
            viewport={"width": WIDTH, "height": HEIGHT}, color_scheme="light", reduced_motion="reduce"
        )
        page.goto(report.resolve().as_uri())
        page.screenshot(path=paths[0])
        page.select_option("#filter-controller", CONTROLLER)
        page.locator("#encounter-table th button", has_text="TTC").click()
        page.locator("tr:not([hidden]) button.open").first.click()
        page.wait_for_function("window.cosimReplay.state() !== null")
        page.locator("#replay").screenshot(path=paths[1])
        started.close()
    return paths


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: python -m studies.screenshots STUDY_DIR OUT_DIR")
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
