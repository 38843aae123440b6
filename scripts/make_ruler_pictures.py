# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Redraws the pictures of the Ruler in docs/images: its page on the examples, in Debian's Chromium, offline.

The recording is the demo's, the robot the simulated one (for its pictures ROS 2 must be installed).
``--only`` draws the pictures whose names are given. ``sheets`` are those of docs/contributors/pictures.md.
"""

from __future__ import annotations

import argparse
import os
import re
import runpy
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from playwright.sync_api import Locator, Page, sync_playwright

from ruler_stage import ROS, record, robot_running, robots_running, served
from ruler_studio import SCREENS, Studio, write_sheet

ROOT = Path(__file__).parents[1]
RECORDING = "demo-out/baseline"
WEEK = {"monday": 60, "tuesday": 20, "wednesday": 5}
"""How long the robot drove on each day of a folder of recordings, in seconds."""
EDITORS = {"editor-3": "warehouse.adirf", "editor-40": "rules_40.adirf", "editor-500": "rules_500.adirf"}
SHEETS = ("home", *EDITORS, "try", "robot", "incident")
IN_CORRIDOR = r"^{topic}.*(3\.[5-9]|4\.\d).*Warehouse Corridor\s*relayed"


def open_rules(page: Page, name: str) -> Locator:
    """Open a rule file and wait for its blocks, which are returned."""
    page.get_by_role("link", name=name, exact=True).click()
    page.get_by_role("button", name="Edit rate").first.wait_for()
    return page.get_by_role("region", name="Blocks", exact=True)


def button(page: Page, name: str) -> Locator:
    """The button with this label."""
    return page.get_by_role("button", name=name, exact=True)


def overview(studio: Studio) -> None:
    """Blocks with the budget above them, text, and findings."""
    page = studio.open_page(height=900)
    open_rules(page, "quality/inspection.adirf")
    button(page, "Text").click()
    page.get_by_role("button", name=re.compile("^Findings")).click()
    page.locator(".budget-bar").filter(has_text="KB/s").wait_for()
    studio.draw(page, "")


def home(studio: Studio) -> None:
    """What somebody sees first."""
    page = studio.open_page()
    page.get_by_role("link", name="warehouse.adirf", exact=True).wait_for()
    studio.draw(page, "home")


def topics(studio: Studio) -> None:
    """The table of topic parameters."""
    page = studio.open_page()
    page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    page.get_by_label("Topic of row 1").wait_for()
    studio.draw(page, "topics")


def trial(studio: Studio) -> None:
    """What the rules do to the demo's recording, among the scaffolding."""
    page = studio.open_page(height=1060, dark=True)
    open_rules(page, "warehouse.adirf")
    button(page, "Text").click()
    button(page, "Try on a recording").click()
    page.get_by_role("combobox", name="Recording").select_option(RECORDING)
    button(page, "Run the rules on it").click()
    slider = page.get_by_role("slider", name="Time in the recording (s)")
    slider.wait_for(timeout=300_000)
    slider.fill("94.8")
    page.get_by_text(re.compile("decides /odom")).wait_for()
    studio.draw(page, "try")


def trial_of_folder(studio: Studio) -> None:
    """What the rules do to a week of recordings, the worst first."""
    page = studio.open_page(height=860)
    open_rules(page, "warehouse.adirf")
    button(page, "Try on a recording").click()
    page.get_by_role("combobox", name="Recording").select_option("week/")
    button(page, "Run the rules on them").click()
    total = page.get_by_role("rowheader", name=f"Total of {len(WEEK)} recordings")
    total.wait_for(timeout=300_000)
    studio.draw(page, "try-folder")


def levels(studio: Studio) -> None:
    """The six levels of /odom on the error at each rate."""
    page = studio.open_page(height=1100)
    page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    page.get_by_role("combobox", name="Topic", exact=True).select_option("/odom")
    page.get_by_role("combobox", name="Recording").select_option(RECORDING)
    button(page, "Show what each rate loses").click()
    button(page, "Use the proposed levels").click(timeout=300_000)
    studio.draw(page.get_by_role("region", name="Quality levels on the curve"), "levels")


def zones(studio: Studio) -> None:
    """A zone on the demo's map that clashes with another rule."""
    page = studio.open_page(width=1440, height=1000)
    blocks = open_rules(page, "warehouse.adirf")
    button(page, "Map").click()
    page.get_by_label("Background").select_option("Map: warehouse_map.yaml")
    page.get_by_label("Path of").select_option(RECORDING)
    button(page, "Draw a rectangle").click()
    for label, metres in (("x from", 3), ("x to", 12), ("y from", 2), ("y to", 10)):
        page.get_by_label(f"{label} (m)").fill(str(metres))
    button(page, "Add the zone").click()
    name = blocks.get_by_role("button", name="Edit name of the rule: Zone 1")
    name.click()
    page.keyboard.type("Crossing")
    page.keyboard.press("Enter")
    button(page, "Crossing").click()
    studio.draw(page, "map")


def incident(studio: Studio) -> None:
    """What a rule recorded of the demo's robot, on the map that its file is drawn on."""
    draw_incident(studio, keep_incident(studio).url)


def keep_incident(studio: Studio) -> Page:
    """Keep what a rule would have recorded; the page shows it."""
    page = studio.open_page()
    open_rules(page, "near_miss.adirf")
    button(page, "Map").click()
    page.get_by_label("Background").select_option("Map: warehouse_map.yaml")
    button(page, "Save").click()
    button(page, "Try on a recording").click()
    page.get_by_role("combobox", name="Recording").select_option(RECORDING)
    button(page, "Run the rules on it").click()
    page.get_by_role("button", name="Keep it: near miss").first.click(timeout=300_000)
    page.get_by_role("region", name="Incidents being kept").get_by_role("link").click(timeout=300_000)
    page.get_by_role("slider", name="Time around the moment (s)").wait_for(timeout=300_000)
    return page


def draw_incident(studio: Studio, url: str) -> None:
    """Draw an incident that is there already."""
    page = studio.open_page(height=950)
    with page.expect_response(re.compile("api/background$"), timeout=300_000):
        page.goto(url)
    page.get_by_role("slider", name="Time around the moment (s)").wait_for()
    page.wait_for_timeout(1000)  # the map is drawn over some pictures
    studio.draw(page, "incident")


def robot(studio: Studio) -> None:
    """What holds on the simulated robot in the corridor, and its rates."""
    page = open_robot(studio)
    wait_for_corridor(page)
    # Looking for the next rule brings both into sight.
    blocks = page.get_by_role("region", name="Blocks", exact=True)
    blocks.get_by_role("button", name="Edit value: 25.5").focus()
    studio.draw(page, "robot")


def open_robot(studio: Studio) -> Page:
    """Open the rules of the simulated robot beside its state."""
    page = studio.open_page(height=1000)
    open_rules(page, "warehouse.adirf")
    button(page, "Robot").click()
    return page


def wait_for_corridor(page: Page) -> None:
    """Wait until the robot has the rates of the corridor, once in a round of 200 s."""
    for topic in ("/odom", "/cmd_vel", "/scan"):
        settled = re.compile(IN_CORRIDOR.format(topic=topic), re.DOTALL)
        page.get_by_role("row").filter(has_text=settled).wait_for(timeout=240_000)


def send(studio: Studio) -> None:
    """What would change on the robot."""
    page = studio.open_page()
    blocks = open_rules(page, "warehouse.adirf")
    blocks.get_by_role("button", name="Edit rate: 10", exact=True).first.click()
    for key in ("Control+a", "2", "0", "Enter"):
        page.keyboard.press(key)
    blocks.get_by_role("button", name="Edit rate: 20", exact=True).wait_for()
    button(page, "Send to robot").click()
    page.get_by_role("dialog").get_by_role("list", name="Differences").wait_for(timeout=120_000)
    studio.draw(page, "send")


def robots(studio: Studio, silent: subprocess.Popen[str]) -> None:
    """Three robots, of which one falls silent and one has no operator."""
    page = studio.open_page(height=420)
    # The name of the place says how many are in trouble.
    page.get_by_role("navigation", name="Places").get_by_role("link", name="Robots").click()
    rows = page.get_by_role("table", name="Robots").locator("tbody").get_by_role("row")
    rows.nth(2).wait_for(timeout=120_000)
    rows.filter(has_text=re.compile(r"ada.*(not the limit|[^.]\d\d KB/s), round trip \d+ ms")).wait_for(
        timeout=120_000
    )
    silent.terminate()
    rows.filter(has_text=re.compile(r"silent for 1\d s")).wait_for(timeout=120_000)
    studio.draw(page, "robots")


def draw_robot(studio: Studio, rules: str, settings: Mapping[str, str]) -> None:
    """What the page shows of one robot."""
    with robot_running(rules, settings):
        robot(studio)
        send(studio)


def draw_robots(studio: Studio, rules: str, settings: Mapping[str, str]) -> None:
    """What the page shows of three."""
    with robots_running(rules, settings) as silent:
        robots(studio, silent)


def editor(studio: Studio, name: str, rules: str) -> None:
    """A rule file, of which the blocks are drawn one after the other."""
    page = studio.open_page()
    open_rules(page, rules)
    page.wait_for_timeout(2500)
    studio.draw(page, name)


def draw_sheets(studio: Studio, wanted: Sequence[str], rules: str, settings: Mapping[str, str]) -> None:
    """Draw pages that everybody sees, each opened on four screens, light and dark."""
    screens = [studio.on(screen) for screen in SCREENS]
    drawn = {"home": home, "try": trial}
    for name in wanted:
        for screen in screens:
            if name in EDITORS:
                editor(screen, name, EDITORS[name])
            elif name in drawn:
                drawn[name](screen)
    if "incident" in wanted:
        url = keep_incident(screens[0]).url
        for screen in screens:
            draw_incident(screen, url)
    if "robot" in wanted:
        draw_robot_sheet(screens, rules, settings)
    (studio.out / "sheets").mkdir(exist_ok=True)
    for name in wanted:
        write_sheet(studio.shots, name, studio.out / "sheets" / f"{name}.webp")


def draw_robot_sheet(screens: Sequence[Studio], rules: str, settings: Mapping[str, str]) -> None:
    """Draw one robot on all screens while it is in the corridor."""
    with robot_running(rules, settings):
        pages = [open_robot(screen) for screen in screens]
        wait_for_corridor(pages[0])
        for screen, page in zip(screens, pages, strict=True):
            page.get_by_role("region", name="Results").evaluate("panel => panel.scrollIntoView()")
            screen.draw(page, "robot")


ALONE_PICTURES = {
    "home": home,
    "overview": overview,
    "topics": topics,
    "trial": trial,
    "folder": trial_of_folder,
    "levels": levels,
    "zones": zones,
    "incident": incident,
}
ROBOT_PICTURES = {"robot": draw_robot, "robots": draw_robots}


def asked() -> argparse.Namespace:
    """What the command line asks for."""
    names = [*ALONE_PICTURES, *ROBOT_PICTURES, "sheets"]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images", help="where the pictures go")
    parser.add_argument("--shots", type=Path, help="where the shots of the sheets stay, as large as they are")
    parser.add_argument("--only", nargs="+", choices=names, default=names, help="draw no others")
    parser.add_argument("--sheets", nargs="+", choices=SHEETS, default=SHEETS, help="draw no other sheets")
    return parser.parse_args()


def copy_of_examples(folder: Path, settings: Mapping[str, str], wanted: Sequence[str]) -> Path:
    """The examples with the demo's recordings and what the ``wanted`` pictures need beside them."""
    project = shutil.copytree(ROOT / "examples", folder / "examples")
    record(project / "demo-out", settings)
    if "folder" in wanted:
        (project / "week").mkdir()
        for day, seconds in WEEK.items():
            record(folder / day, settings, "--seconds", str(seconds))
            shutil.move(folder / day / "baseline", project / "week" / day)
    if "sheets" in wanted:
        rule_file = runpy.run_path(str(ROOT / "benchmarks" / "live" / "zone_rules.py"))["rule_file"]
        for number in (40, 500):
            (project / f"rules_{number}.adirf").write_text(rule_file(number), encoding="utf-8")
    return project


def main() -> None:
    """Serve a copy of the examples, so that the page writes nothing into the checkout."""
    wanted = asked()
    paths = [str(ROOT / "src"), *filter(None, [os.environ.get("PYTHONPATH")])]
    settings = {**ROS, "PYTHONPATH": os.pathsep.join(paths)}
    with tempfile.TemporaryDirectory() as temporary, sync_playwright() as playwright:
        shots = wanted.shots or Path(temporary, "shots")
        for folder in (wanted.out, shots):
            folder.mkdir(parents=True, exist_ok=True)
        project = copy_of_examples(Path(temporary), settings, wanted.only)
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for name in wanted.only:
            # Each has a server of its own, which has heard of no other robots.
            with served(project, settings) as url:
                studio = Studio(browser=browser, url=url, out=wanted.out, shots=shots)
                if name in ALONE_PICTURES:
                    ALONE_PICTURES[name](studio)
                elif name in ROBOT_PICTURES:
                    ROBOT_PICTURES[name](studio, str(project / "warehouse.adirf"), settings)
                else:
                    draw_sheets(studio, wanted.sheets, str(project / "warehouse.adirf"), settings)
        browser.close()


if __name__ == "__main__":
    main()
