# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Redraws docs/images/ruler*.png: the Ruler's page on the examples, in Debian's Chromium, with no network.

The recording is the demo's, the robot the simulated one (for its pictures ROS 2 must be installed).
``--only`` draws the pictures whose names are given.
"""

from __future__ import annotations

import argparse
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Locator, Page, sync_playwright

ROOT = Path(__file__).parents[1]
TESTUDO = [sys.executable, "-m", "smarttestudo"]
ROS = {
    **os.environ,
    "ROS_DOMAIN_ID": "88",
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    "PYTHONUNBUFFERED": "1",
}
LINKED, ALONE = "tcp/127.0.0.1:7457", "tcp/127.0.0.1:7458"
"""Where an operator's end listens, and where none does."""
RECORDING = "demo-out/baseline"
IN_CORRIDOR = r"^{topic}.*4\.\d.*Warehouse Corridor\s*relayed"
LISTEN = """
import contextlib, importlib, sys, rclpy, rclpy.executors
rclpy.init()
node = rclpy.create_node("operator")
for topic, kind in zip(sys.argv[1::2], sys.argv[2::2]):
    package, name = kind.split("/msg/")
    message = getattr(importlib.import_module(package + ".msg"), name)
    node.create_subscription(message, topic, lambda _: None, 10)
with contextlib.suppress(rclpy.executors.ExternalShutdownException):
    rclpy.spin(node)
"""
HEARD = {
    "/testudo/odom": "nav_msgs/msg/Odometry",
    "/testudo/cmd_vel": "geometry_msgs/msg/Twist",
    "/testudo/scan": "sensor_msgs/msg/LaserScan",
    "/testudo/camera/camera_info": "sensor_msgs/msg/CameraInfo",
    "/testudo/imu": "sensor_msgs/msg/Imu",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Studio:
    """Where pictures are drawn: a browser, the address of a Ruler, and the folder that they go to."""

    browser: Browser
    url: str
    out: Path

    def open_page(self, *, height: int = 800, width: int = 1280, dark: bool = False) -> Page:
        """A new tab on the home screen of who knows the page."""
        page = self.browser.new_page(
            viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light"
        )
        page.add_init_script("localStorage.setItem('tour', 'seen')")
        page.goto(self.url)
        return page

    def draw(self, shown: Page | Locator, name: str) -> None:
        """Write ``ruler-NAME.png``, or ``ruler.png``, in 256 colours: a third of the bytes."""
        picture = Image.open(io.BytesIO(shown.screenshot(animations="disabled")))
        path = self.out / ("-".join(["ruler", name]) if name else "ruler")
        few = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
        few.save(path.with_suffix(".png"), optimize=True)


def open_rules(page: Page, name: str) -> Locator:
    """Open a rule file and wait for its blocks, which are returned."""
    page.get_by_role("link", name=name, exact=True).click()
    page.get_by_role("button", name="Edit rate").first.wait_for()
    return page.get_by_role("region", name="Blocks", exact=True)


def button(page: Page, name: str) -> Locator:
    """The button with this label."""
    return page.get_by_role("button", name=name, exact=True)


def overview(studio: Studio) -> None:
    """Blocks, text, and the load of each situation against the budget."""
    page = studio.open_page(height=900)
    open_rules(page, "quality/inspection.adirf")
    button(page, "Optimize and Download").click()
    page.get_by_label("Topic parameters").select_option("quality/radio.toml")
    button(page, "Download rates").wait_for()
    page.get_by_text("Inspection", exact=True).last.wait_for()
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
    page.get_by_role("tab", name="Try on a recording", exact=True).click()
    page.get_by_role("combobox", name="Recording").select_option(RECORDING)
    button(page, "Run the rules on it").click()
    slider = page.get_by_role("slider", name="Time in the recording (s)")
    slider.wait_for(timeout=300_000)
    slider.fill("94.8")
    page.get_by_text(re.compile("decides /odom")).wait_for()
    studio.draw(page, "try")


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
    page = studio.open_page(width=1440, height=900)
    blocks = open_rules(page, "warehouse.adirf")
    page.get_by_role("tab", name="Map", exact=True).click()
    page.get_by_label("Background").select_option("Map: warehouse_map.yaml")
    page.get_by_label("Path of").select_option(RECORDING)
    button(page, "Type a zone").click()
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
    page = studio.open_page(height=950)
    open_rules(page, "near_miss.adirf")
    page.get_by_role("tab", name="Map", exact=True).click()
    page.get_by_label("Background").select_option("Map: warehouse_map.yaml")
    button(page, "Save").click()
    page.get_by_role("tab", name="Try on a recording", exact=True).click()
    page.get_by_role("combobox", name="Recording").select_option(RECORDING)
    button(page, "Run the rules on it").click()
    page.get_by_role("button", name="Keep it: near miss").first.click(timeout=300_000)
    with page.expect_response(re.compile("api/background$"), timeout=300_000):
        page.get_by_role("region", name="Incidents being kept").get_by_role("link").click(timeout=300_000)
    page.get_by_role("figure", name="Rate of /scan").wait_for()
    page.wait_for_timeout(1000)  # the map is drawn over some pictures
    studio.draw(page, "incident")


def robot(studio: Studio) -> None:
    """What holds on the simulated robot in the corridor, and its rates."""
    page = studio.open_page(height=1000)
    blocks = open_rules(page, "warehouse.adirf")
    page.get_by_role("tab", name="Robot", exact=True).click()
    blocks.get_by_text("✓ holds").first.wait_for(timeout=120_000)
    for topic in ("/odom", "/cmd_vel", "/scan"):
        settled = re.compile(IN_CORRIDOR.format(topic=topic), re.DOTALL)
        page.get_by_role("row").filter(has_text=settled).wait_for(timeout=120_000)
    # Looking for the next rule brings both into sight.
    blocks.get_by_role("button", name="Edit value: 25.5").focus()
    studio.draw(page, "robot")


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
    page = studio.open_page(height=390)
    button(page, "Watch Robots").click()
    rows = page.get_by_role("table", name="Robots").locator("tbody").get_by_role("row")
    rows.nth(2).wait_for(timeout=120_000)
    rows.filter(has_text=re.compile(r"ada.*(not the limit|[^.]\d\d KB/s), round trip.*\d+ ms /")).wait_for(
        timeout=120_000
    )
    silent.terminate()
    rows.filter(has_text=re.compile(r"silent for 1\d s")).wait_for(timeout=120_000)
    studio.draw(page, "robots")


@contextmanager
def running(command: list[str], settings: Mapping[str, str]) -> Iterator[subprocess.Popen[str]]:
    """A process that ends with the block."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=settings) as process:
        try:
            yield process
        finally:
            process.terminate()


@contextmanager
def served(project: Path, settings: Mapping[str, str]) -> Iterator[str]:
    """``testudo ruler`` on a folder; yields its address."""
    command = [*TESTUDO, "ruler", str(project), "--port", "0", "--no-browser"]
    with running(command, settings) as server:
        assert server.stdout is not None
        yield server.stdout.readline().split(": ", 1)[1].split()[0]


def draw_robot(studio: Studio, rules: str, settings: Mapping[str, str]) -> None:
    """Start the simulated robot, a run that follows ``rules``, and an operator."""
    names = [word for pair in HEARD.items() for word in pair]
    with ExitStack() as stack:
        for command in (
            [*TESTUDO, "run", "--rules", rules, "--budget", "400"],
            [*TESTUDO, "simulate"],
            [sys.executable, "-c", LISTEN, *names],
        ):
            stack.enter_context(running(command, settings))
        for draw in (robot, send):
            draw(studio)


def draw_robots(studio: Studio, rules: str, settings: Mapping[str, str]) -> None:
    """Start three runs beside one simulated robot, of which two have a link."""
    run = [*TESTUDO, "run", "--rules", rules]
    names = [["--ros-args", "-r", f"__ns:=/{name}"] for name in ("ada", "bob", "cleo")]
    with ExitStack() as stack:
        for command in (
            [*TESTUDO, "simulate"],
            [*TESTUDO, "receive", "--no-ros", "--openmetrics", "0", "--listen", LINKED],
            [*run, "--budget", "400", "--robot", "ada", "--link", LINKED, *names[0]],
            [*run, "--robot", "bob", "--link", ALONE, *names[1]],
        ):
            stack.enter_context(running(command, settings))
        silent = stack.enter_context(running([*run, "--output-topic", "/cleo{topic}", *names[2]], settings))
        robots(studio, silent)


ALONE_PICTURES = {
    "home": home,
    "overview": overview,
    "topics": topics,
    "trial": trial,
    "levels": levels,
    "zones": zones,
    "incident": incident,
}
ROBOT_PICTURES = {"robot": draw_robot, "robots": draw_robots}


def asked() -> argparse.Namespace:
    """What the command line asks for."""
    names = [*ALONE_PICTURES, *ROBOT_PICTURES]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images", help="where the pictures go")
    parser.add_argument("--only", nargs="+", choices=names, default=names, help="draw no others")
    return parser.parse_args()


def main() -> None:
    """Serve a copy of the examples, so that the page writes nothing into the checkout."""
    wanted = asked()
    paths = [str(ROOT / "src"), *filter(None, [os.environ.get("PYTHONPATH")])]
    settings = {**ROS, "PYTHONPATH": os.pathsep.join(paths)}
    wanted.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        project = shutil.copytree(ROOT / "examples", Path(folder, "examples"))
        demo = [*TESTUDO, "demo", "--out", str(project / "demo-out")]
        subprocess.run(demo, check=True, stdout=subprocess.DEVNULL, env=settings)
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        with served(project, settings) as url:
            studio = Studio(browser=browser, url=url, out=wanted.out)
            for name in wanted.only:
                if name in ALONE_PICTURES:
                    ALONE_PICTURES[name](studio)
                else:
                    ROBOT_PICTURES[name](studio, str(project / "warehouse.adirf"), settings)
        browser.close()


if __name__ == "__main__":
    main()
