# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""SmartTestudo as a package of a ROS workspace: what colcon builds and ros2 run starts."""

from __future__ import annotations

import ast
import importlib.util
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import tomli

from ros.ros_processes import SmallRobot
from ros_package.workspace import ROOT, colcon_tested
from smarttestudo import __version__

RULES = "begin SetFrequency /imu 10 end"
IMU = {"type": "sensor_msgs/msg/Imu"}


def in_environment_of(package: Path, executable: Path) -> list[str]:
    """The command that starts an executable as ros2 run does, after the setup file of its workspace."""
    return ["sh", "-c", '. "$0" && exec "$@"', str(package.parent / "local_setup.sh"), str(executable)]


def test_ros2_run_finds_an_executable_that_relays_until_a_signal_comes(
    robot: SmallRobot, installed: Path
) -> None:
    rules = robot.folder / "rules.adirf"
    rules.write_text(RULES, encoding="utf-8")
    operator = robot.operator(imu=IMU)
    executable = installed / "lib" / "smarttestudo" / "smart_testudo"
    runtime = robot.command(
        *in_environment_of(installed, executable),
        *("--rules", str(rules), "--ros-args", "-r", "__node:=testudo_of_the_workspace"),
    )
    robot.source(imu={**IMU, "hz": 50})
    operator.line_with("heard")
    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0
    assert any("[testudo_of_the_workspace]: /imu: 10 Hz (default)" in line for line in runtime.output)
    (data_path,) = (line for line in runtime.output if "Data path: " in line)
    assert ("no compiled relays" in data_path) == (shutil.which("cc") is None)


def test_launch_files_worlds_profiles_rules_and_the_service_are_shared(installed: Path) -> None:
    share = installed / "share"
    assert (share / "ament_index" / "resource_index" / "packages" / "smarttestudo").is_file()
    sources = {name: ROOT / name for name in ("launch", "worlds", "examples", "extras")}
    sources["profiles"] = ROOT / "src/smarttestudo/rules/presets"
    for folder, source in sources.items():
        shared = share / "smarttestudo" / folder
        assert files_below(source)
        assert files_below(shared) == files_below(source)


def files_below(folder: Path) -> set[Path]:
    return {path.relative_to(folder) for path in folder.rglob("*") if path.is_file()}


def test_a_build_by_links_holds_the_same_package(installed: Path, linked: Path) -> None:
    for folder in ("share/smarttestudo", "lib/smarttestudo"):
        names = {path.name for path in (installed / folder).iterdir()}
        assert {path.name for path in (linked / folder).iterdir()} >= names - {"hook"}
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    for name in ("testudo", "smart_testudo"):
        command = [*in_environment_of(linked, linked / "lib" / "smarttestudo" / name), "--help"]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith("usage: testudo")


def test_colcon_test_runs_the_tests_of_the_package_on_what_it_installed(installed: Path) -> None:
    results = colcon_tested(installed.parents[1])
    assert [(suite.get("errors"), suite.get("failures"), suite.get("skipped")) for suite in results] == [
        ("0", "0", "0")
    ]
    assert len(results.findall(".//testcase")) == 2


def test_package_xml_depends_on_every_ros_package_that_is_used() -> None:
    package = ElementTree.parse(ROOT / "package.xml").getroot()
    trees = [
        ast.parse(path.read_text(encoding="utf-8"))
        for path in (ROOT / "src" / "smarttestudo" / "robot" / "ros").rglob("*.py")
    ]
    nodes = [node for tree in trees for node in ast.walk(tree)]
    imported = {
        node.module.partition(".")[0] for node in nodes if isinstance(node, ast.ImportFrom) and node.module
    }
    texts = [node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    of_types = {match[1] for text in texts if (match := re.fullmatch(r"(\w+)/msg/\w+", text))}
    used = {name for name in imported if name not in sys.stdlib_module_names} | of_types
    # Ours, and the type to fall back on where std_msgs is missing.
    used -= {"smarttestudo", "sensor_msgs"}
    assert used >= {"rclpy", "rcl_interfaces", "builtin_interfaces", "std_msgs", "std_srvs"}
    assert used <= {one.text for one in package.findall("exec_depend")}


def test_package_xml_says_what_pyproject_says() -> None:
    package = ElementTree.parse(ROOT / "package.xml").getroot()
    project = tomli.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert package.findtext("name") == project["name"]
    assert package.findtext("version") == __version__
    assert package.findtext("description") == project["description"]
    licence = package.find("license")
    assert licence is not None
    assert licence.text == "Apache-2.0"
    assert (ROOT / licence.get("file", "")).is_file()
    assert [package.findtext("author")] == [author["name"] for author in project["authors"]]


def test_package_xml_names_what_the_tests_of_a_workspace_need() -> None:
    package = ElementTree.parse(ROOT / "package.xml").getroot()
    named = {one.text for kind in ("exec_depend", "test_depend") for one in package.findall(kind)}
    types = {
        match[1]
        for path in (ROOT / "tests" / "ros").glob("*.py")
        for match in re.finditer(r"\"(\w+_msgs)/msg/", path.read_text(encoding="utf-8"))
    }
    # Others are made up, to be unknown.
    assert {name for name in types if importlib.util.find_spec(name)} <= named
    assert {"python3-pytest", "python3-hypothesis"} <= named
