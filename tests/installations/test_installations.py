# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Every installation that the documentation offers does what it is for, and says what it lacks."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from bags.many.dask_processes import dask_processes
from cli.test_command_lines import COMMANDS
from installations.environments import (
    LIMIT_S,
    ROOT,
    Environment,
    clean_variables,
    copy_checkout,
    does,
    run,
    with_python3,
)
from link.zenoh.ends import free_endpoint, until
from ros.ros_processes import Process, SmallRobot
from smarttestudo.domain.errors import Extra, how_to_install

ODOM = {"type": "nav_msgs/msg/Odometry", "hz": 50}
RULES = """begin
    SetFrequency /odom 10
    Rule "moves"
    If (CheckValue /odom pose_x > 1)
    Then
        SetFrequency /odom 20
        Record "moved" Before 1 s After 1 s
    EndIf
end
"""
WITHIN_S = 60.0
ALL_HELP = """
import contextlib, sys
from smarttestudo.cli.main import main
for command in sys.argv[1:]:
    with contextlib.suppress(SystemExit):
        main([command, "--help"])
"""


@contextmanager
def process(environment: Environment, *arguments: str | Path, **variables: str) -> Iterator[Process]:
    """``testudo`` with ``arguments``, until the block ends."""
    started = Process(
        environment.command(*arguments), {**clean_variables(), "PYTHONUNBUFFERED": "1", **variables}
    )
    try:
        yield started
    finally:
        started.end()


def until_it_does(environment: Environment, *arguments: str | Path) -> str:
    """What ``testudo`` prints once it succeeds; a robot is not heard at once."""
    end_s = time.monotonic() + WITHIN_S
    while (done := environment.run(*arguments)).returncode != 0:
        assert time.monotonic() < end_s, done.stderr
    return done.stdout


def test_with_the_standard_library_alone_rules_are_checked_and_every_command_explains_itself(
    bare: Environment,
) -> None:
    bare.does("fmt", "--check", ".")
    assert json.loads(bare.does("check", "--format", "json", "warehouse.adirf"))
    (bare.desk / "kept").mkdir()
    assert bare.does("incidents", "list", "kept", "--json") == "[]\n"
    done = run([bare.python, "-S", "-c", ALL_HELP, *COMMANDS], cwd=ROOT / "src")
    assert (done.returncode, done.stderr) == (0, "")
    assert re.findall(r"^usage: testudo (\w+) ", done.stdout, re.MULTILINE) == list(COMMANDS)


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (["demo"], "studio"),
        (["bag", "info", "bag"], "studio"),
        (["replay", "bag", "--rules", "warehouse.adirf", "--output", "out"], "studio"),
        (["profile", "--bag", "bag"], "studio"),
        (["check", "warehouse.adirf", "--bag", "bag"], "studio"),
        (["ruler", "--no-browser"], "studio"),
        (["receive", "--no-ros", "--foxglove", "0"], "link"),
        (["top", "--connect", "tcp/127.0.0.1:1"], "link"),
        (["incidents", "list", "--connect", "tcp/127.0.0.1:1"], "link"),
        (["run", "--rules", "warehouse.adirf"], "ros"),
        (["top", "--once"], "ros"),
        (["echo", "/odom"], "ros"),
        (["simulate"], "ros"),
        (["simulate", "--physics"], "physics"),
    ],
)
def test_what_is_not_installed_is_one_line_with_the_command_that_installs_it(
    bare: Environment, arguments: list[str], extra: str
) -> None:
    line = bare.refuses(*arguments)
    assert line.endswith(f"in the checkout of SmartTestudo, run: {bare.python} -m pip install '.[{extra}]'")


def test_receiving_without_ros_says_what_goes_without_it(with_link: Environment) -> None:
    assert with_link.refuses("receive") == (
        "error: publishing what arrives on a ROS graph needs ROS 2 (rclpy); source your ROS setup, "
        "or go without: --no-ros and --record DIR, --incidents DIR, --catch-up DIR, --foxglove PORT "
        "or --openmetrics PORT"
    )


def test_a_workspace_with_rclpy_alone_relays_records_shows_and_measures(
    with_rclpy: Environment, robot: SmallRobot
) -> None:
    rules = with_rclpy.desk / "moves.adirf"
    rules.write_text(RULES, encoding="utf-8")
    robot.source(odom={**ODOM, "x": 2.0})

    def started(*arguments: str | Path) -> Process:
        return robot.command(*with_rclpy.command(*arguments), **with_rclpy.variables)

    runtime = started("run", "--rules", rules, "--incidents", with_rclpy.desk / "kept")
    runtime.line_with("Relaying")
    # A topic is relayed while somebody subscribes.
    assert started("echo", "/testudo/odom", "--count", "20", "--json").exit_code() == 0
    top = started("top", "--once", "--json", "--timeout", "60")
    assert top.exit_code() == 0
    assert "/odom" in "".join(top.output)
    measured = with_rclpy.desk / "measured.toml"
    assert started("profile", "--seconds", "1", "--timeout", "60", "-o", measured).exit_code() == 0
    assert '[topics."/odom"]' in measured.read_text(encoding="utf-8")
    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0
    (incident,) = json.loads(with_rclpy.does("incidents", "list", "kept", "--json"))
    assert incident["rule"] == "moves"


def test_the_operators_end_needs_the_extra_link_alone(
    with_link: Environment, with_studio: Environment, robot: SmallRobot
) -> None:
    endpoint, desk = free_endpoint(), with_link.desk
    (desk / "moves.adirf").write_text(RULES, encoding="utf-8")
    robot.source(odom={**ODOM, "x": 2.0})
    places = ("--record", desk / "recorded", "--foxglove", "0", "--incidents", desk / "fetched")
    with process(with_link, "receive", "--listen", endpoint, *places) as receiver:
        receiver.line_with("nothing is published on a ROS graph, as with --no-ros")
        receiver.line_with("Receiving")
        link = ("--link", endpoint, "--robot", "ada", "--incidents", str(robot.folder / "kept"))
        robot.runtime(RULES, *link).line_with("Relaying")
        shown = until_it_does(with_link, "top", "--connect", endpoint, "--once", "--json")
        assert "/odom" in shown
        until_it_does(with_link, "check", "moves.adirf", "--connect", endpoint, "--robot", "ada")
        # What was fetched is listed, too.
        receiver.line_with("moved")
        listed = until_it_does(with_link, "incidents", "list", "--connect", endpoint, "--json")
        assert json.loads(listed)[0]["rule"] == "moves"
        receiver.signal(signal.SIGINT)
        assert receiver.exit_code() == 0
    info = json.loads(with_studio.does("bag", "info", desk / "recorded" / "ada", "--json"))
    assert info["topics"]["/odom"]["messages"] > 0


def test_a_laptop_with_the_extra_studio_needs_no_ros(with_studio: Environment) -> None:
    with_studio.does("demo", "--seconds", "10", "--out", "demo-out")
    (bag, adaptive) = sorted(Path(with_studio.desk / "demo-out").glob("*/metadata.yaml"))
    with_studio.does("bag", "compare", adaptive.parent, bag.parent)
    with_studio.does("check", "warehouse.adirf", "--bag", bag.parent)
    with_studio.does("profile", "--bag", bag.parent, "-o", "measured.toml")
    with_studio.does("replay", bag.parent, "--rules", "warehouse.adirf", "--output", "replayed")
    with_studio.does("bag", "rates", bag.parent, "--figures", "figures")
    levels = with_studio.desk / "quality"
    (rules, *_), (profile, *_) = sorted(levels.glob("*.adirf")), sorted(levels.glob("*.toml"))
    with_studio.does("optimize", rules, "--profile", profile)
    with process(with_studio, "ruler", with_studio.desk, "--no-browser", "--port", "0") as ruler:
        address = re.search(r"http://\S+", ruler.line_with("http://"))
        assert address is not None
        with urllib.request.urlopen(address[0]) as page:
            assert page.status == 200


def test_many_recordings_on_a_cluster_and_in_tables_need_the_extra_fleet_alone(
    with_fleet: Environment, with_studio: Environment, tmp_path: Path
) -> None:
    with_fleet.does("demo", "--seconds", "5", "--out", "demo-out")
    measure = ("bag", "rates", with_fleet.desk / "demo-out", "--topics", "/odom", "--json")
    here = with_fleet.does(*measure, "--parquet", "tables")
    assert len(here.splitlines()) == 2
    assert [*(with_fleet.desk / "tables").rglob("*.parquet")]
    with dask_processes(tmp_path, workers=1, python=with_fleet.python) as cluster:
        assert with_fleet.does(*measure, "--dask", cluster.address) == here
    # Its S3 is not there, which is the store's fault and not that of a package.
    lost = with_fleet.run("bag", "info", "s3://fleet/monday.mcap", "--timeout", "1")
    assert (lost.returncode, "package" in lost.stderr) == (1, False)
    for option in (("--dask", "tcp://127.0.0.1:1"), ("--parquet", "tables")):
        line = with_studio.refuses(*measure, *option)
        assert line.endswith(f"run: {with_studio.python} -m pip install '.[fleet]'")


def test_a_robot_with_the_extra_metrics_serves_them(with_metrics: Environment, robot: SmallRobot) -> None:
    rules = with_metrics.desk / "warehouse.adirf"
    runtime = robot.command(*with_metrics.command("run", "--rules", rules, "--openmetrics", "0"))
    address = re.search(r"http://\S+/metrics", runtime.line_with("/metrics"))
    assert address is not None
    with urllib.request.urlopen(address[0]) as metrics:
        assert b"testudo_" in metrics.read()


def test_with_the_extra_ros_a_laptop_simulates_a_robot_and_hears_it(
    with_ros: Environment, robot: SmallRobot
) -> None:
    robot.command(*with_ros.command("simulate", "--seconds", "60"))
    echo = robot.command(*with_ros.command("echo", "/odom", "--once"))
    assert echo.exit_code() == 0
    with_ros.does("bag", "--help")


def test_the_three_minutes_of_the_readme_lead_to_a_live_relay_and_its_errors_to_what_is_missing(
    domain: int, tmp_path: Path
) -> None:
    checkout = tmp_path / "checkout"
    copy_checkout(checkout)
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"^## Three minutes.*?^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert block is not None
    *lines, top = [line.partition("#")[0].rstrip() for line in block[1].splitlines()]
    script = "\n".join([*lines, f"{top} > top.txt &", "wait"])
    variables = {
        **clean_variables(),
        **with_python3(),
        "PYTHONUNBUFFERED": "1",
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    with subprocess.Popen(
        ["sh", "-ec", script], cwd=checkout, env=variables, start_new_session=True, stdout=subprocess.PIPE
    ) as shell:
        try:
            shown = checkout / "top.txt"
            until(
                lambda: (
                    shown.exists()
                    and re.search(r"/odom +\d.* default", shown.read_text(errors="replace")) is not None
                ),
                within_s=LIMIT_S,
            )
        finally:
            # What a shell starts in its background is not interrupted by Ctrl-C.
            os.killpg(shell.pid, signal.SIGTERM)
    receive = ["testudo-venv/bin/testudo", "receive", "--no-ros", "--openmetrics", "0"]
    (line,) = run(receive, cwd=checkout).stderr.splitlines()
    cause, _, command = line.partition("; in the checkout of SmartTestudo, run: ")
    assert cause == "error: a link needs the package zenoh"
    does(["sh", "-c", command], cwd=checkout)
    refused = run(receive, cwd=checkout).stderr
    assert refused.startswith("error: --openmetrics needs the package prometheus-client; in the checkout")


def test_outside_an_environment_an_error_says_how_to_make_one(monkeypatch: pytest.MonkeyPatch) -> None:
    # As of a robot's own Python.
    monkeypatch.setattr(sys, "prefix", sys.base_prefix)
    assert how_to_install(Extra.LINK) == (
        "in the checkout of SmartTestudo, run: python3 -m venv --system-site-packages testudo-venv && "
        "testudo-venv/bin/pip install '.[link]'; then use testudo-venv/bin/testudo"
    )
