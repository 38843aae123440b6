# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Redraws docs/images/ruler*.png: the Ruler's page on the examples, in Debian's Chromium, with no network.

The recording is the demo's, the robot the simulated one (for its picture ROS 2 must be installed).
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Locator, Page, sync_playwright

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "docs" / "images"
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


def open_page(browser: Browser, url: str, *, height: int, width: int = 1280, dark: bool = False) -> Page:
    """A new tab on the home screen."""
    page = browser.new_page(
        viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light"
    )
    page.goto(url)
    return page


def open_rules(page: Page, name: str) -> Locator:
    """Open a rule file and wait for its blocks, which are returned."""
    page.get_by_role("link", name=name, exact=True).click()
    page.get_by_role("button", name="Edit rate").first.wait_for()
    return page.get_by_role("region", name="Blocks", exact=True)


def button(page: Page, name: str) -> Locator:
    """The button with this label."""
    return page.get_by_role("button", name=name, exact=True)


def overview(browser: Browser, url: str) -> None:
    """Blocks, text, and the load of each situation against the budget."""
    page = open_page(browser, url, height=900)
    open_rules(page, "quality/inspection.adirf")
    button(page, "Optimize and Download").click()
    page.get_by_label("Topic parameters").select_option("quality/radio.toml")
    button(page, "Download rates").wait_for()
    page.get_by_text("Inspection", exact=True).last.wait_for()
    page.screenshot(path=IMAGES / "ruler.png")


def trial(browser: Browser, url: str) -> None:
    """What the rules do to the demo's recording, among the scaffolding."""
    page = open_page(browser, url, height=1060, dark=True)
    open_rules(page, "warehouse.adirf")
    page.get_by_role("tab", name="Try on a bag", exact=True).click()
    page.get_by_role("combobox", name="Recording").select_option(RECORDING)
    button(page, "Run the rules on it").click()
    slider = page.get_by_role("slider", name="Time in the recording (s)")
    slider.wait_for(timeout=300_000)
    slider.fill("94.8")
    page.get_by_text(re.compile("decides /odom")).wait_for()
    page.screenshot(path=IMAGES / "ruler-try.png")


def levels(browser: Browser, url: str) -> None:
    """The six levels of /odom on the error at each rate."""
    page = open_page(browser, url, height=1100)
    page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    page.get_by_role("combobox", name="Topic", exact=True).select_option("/odom")
    page.get_by_role("combobox", name="Recording").select_option(RECORDING)
    button(page, "Show what each rate loses").click()
    button(page, "Use the proposed levels").click(timeout=300_000)
    page.get_by_role("region", name="Quality levels on the curve").screenshot(
        path=IMAGES / "ruler-levels.png"
    )


def zones(browser: Browser, url: str) -> None:
    """A zone on the demo's map that clashes with another rule."""
    page = open_page(browser, url, width=1440, height=900)
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
    page.screenshot(path=IMAGES / "ruler-map.png")


def robot(browser: Browser, url: str) -> None:
    """What holds on the simulated robot in the corridor, and its rates."""
    page = open_page(browser, url, height=1000)
    blocks = open_rules(page, "warehouse.adirf")
    page.get_by_role("tab", name="Robot", exact=True).click()
    blocks.get_by_text("✓ holds").first.wait_for(timeout=120_000)
    for topic in ("/odom", "/cmd_vel", "/scan"):
        settled = re.compile(IN_CORRIDOR.format(topic=topic), re.DOTALL)
        page.get_by_role("row").filter(has_text=settled).wait_for(timeout=120_000)
    # Looking for the next rule brings both into sight.
    blocks.get_by_role("button", name="Edit value: 25.5").focus()
    page.screenshot(path=IMAGES / "ruler-robot.png")


def robots(browser: Browser, url: str, silent: subprocess.Popen[str]) -> None:
    """Three robots, of which one falls silent and one has no operator."""
    page = open_page(browser, f"{url}#/robots/", height=390)
    rows = page.get_by_role("table", name="Robots").locator("tbody").get_by_role("row")
    rows.nth(2).wait_for(timeout=120_000)
    rows.filter(has_text=re.compile(r"/ada/.*(not the limit|[^.]\d\d KB/s), round trip.*\d+ ms /")).wait_for(
        timeout=120_000
    )
    silent.terminate()
    rows.filter(has_text=re.compile(r"silent for 1\d s")).wait_for(timeout=120_000)
    page.screenshot(path=IMAGES / "ruler-robots.png")


@contextmanager
def running(command: list[str], settings: Mapping[str, str]) -> Iterator[subprocess.Popen[str]]:
    """A process that ends with the block."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=settings) as process:
        try:
            yield process
        finally:
            process.terminate()


@contextmanager
def served(project: Path) -> Iterator[str]:
    """``testudo ruler`` on a folder; yields its address."""
    command = [*TESTUDO, "ruler", str(project), "--port", "0", "--no-browser"]
    with running(command, ROS) as server:
        assert server.stdout is not None
        yield server.stdout.readline().split(": ", 1)[1].split()[0]


def draw_robots(browser: Browser, url: str, rules: str) -> None:
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
            stack.enter_context(running(command, ROS))
        silent = stack.enter_context(running([*run, "--output-topic", "/cleo{topic}", *names[2]], ROS))
        robots(browser, url, silent)


def main() -> None:
    """Serve a copy of the examples, so that the page writes nothing into the checkout."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        project = shutil.copytree(ROOT / "examples", Path(folder, "examples"))
        subprocess.run(
            [*TESTUDO, "demo", "--out", str(project / "demo-out")], check=True, stdout=subprocess.DEVNULL
        )
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        with served(project) as url:
            for draw in (overview, trial, levels, zones):
                draw(browser, url)
            with ExitStack() as stack:
                rules = str(project / "warehouse.adirf")
                names = [word for pair in HEARD.items() for word in pair]
                for command in (
                    [*TESTUDO, "run", "--rules", rules, "--budget", "400"],
                    [*TESTUDO, "simulate"],
                    [sys.executable, "-c", LISTEN, *names],
                ):
                    stack.enter_context(running(command, ROS))
                robot(browser, url)
            draw_robots(browser, url, str(project / "warehouse.adirf"))
        browser.close()


if __name__ == "__main__":
    main()
