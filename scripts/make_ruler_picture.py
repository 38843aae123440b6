# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Redraws docs/images/ruler.png: the Ruler's page on an example, in Debian's Chromium, with no network."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).parents[1]
PICTURE = ROOT / "docs" / "images" / "ruler.png"
SIZE = {"width": 1280, "height": 900}


def draw(page: Page, url: str) -> None:
    """Open the example, let the optimizer work, and take the picture."""
    page.goto(url)
    page.get_by_text("quality/inspection.adirf").first.click()
    page.get_by_role("button", name="Optimize and Download").click()
    page.get_by_label("Topic parameters").select_option("quality/radio.toml")
    page.get_by_role("button", name="Download rates").wait_for()
    page.get_by_text("Inspection", exact=True).last.wait_for()
    page.screenshot(path=PICTURE)


def main() -> None:
    """Serve a copy of the examples, so that the page writes nothing into the checkout."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        project = shutil.copytree(ROOT / "examples", Path(folder, "examples"))
        command = [sys.executable, "-m", "smarttestudo", "ruler", str(project), "--port", "0", "--no-browser"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            chromium = shutil.which("chromium")
            browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
            url = server.stdout.readline().split(": ", 1)[1].split()[0] if server.stdout else ""
            draw(browser.new_page(viewport=SIZE), url)
            browser.close()
            server.terminate()


if __name__ == "__main__":
    main()
