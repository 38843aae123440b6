# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Launch files, a verb of ros2 and analyzers are as the tools of ROS read them, which PyPI lacks."""

from __future__ import annotations

import argparse
import ast
import importlib
import io
import sys
from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree

import pytest
import tomli
from ruamel.yaml import YAML

from robot.status.statuses import STATUS
from ros_package.workspace import ROOT
from smarttestudo import __version__
from smarttestudo.cli.commands import command_parser
from smarttestudo.robot.diagnostics import diagnostics

LAUNCH = ROOT / "launch"
ASKED = {"rules", "profile", "link", "incidents", "decisions", "namespace"}


def constants(name: str) -> Mapping[str, Any]:
    """Tables of a launch file by name."""
    tree = ast.parse((LAUNCH / name).read_text(encoding="utf-8"))
    return {
        node.targets[0].id: ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }


def of_xml() -> tuple[Mapping[str, str], Mapping[str, str], str]:
    """The arguments that the launch file in XML declares and passes on, and the file to which."""
    launch = ElementTree.parse(LAUNCH / "testudo.launch.xml").getroot()
    include = launch.find("include")
    assert include is not None
    return (
        {one.attrib["name"]: one.attrib["description"] for one in launch.findall("arg")},
        {one.attrib["name"]: one.attrib["value"] for one in include.findall("arg")},
        include.attrib["file"],
    )


def of_yaml() -> tuple[Mapping[str, str], Mapping[str, str], str]:
    """The same of the one in YAML."""
    entries = YAML(typ="safe").load(LAUNCH / "testudo.launch.yaml")["launch"]
    (include,) = (one["include"] for one in entries if "include" in one)
    return (
        {one["arg"]["name"]: one["arg"]["description"] for one in entries if "arg" in one},
        {one["name"]: one["value"] for one in include["arg"]},
        include["file"],
    )


def test_each_argument_of_the_launch_file_is_an_option_of_run() -> None:
    file = constants("testudo.launch.py")
    arguments, options = file["ARGUMENTS"], file["OPTIONS"]
    assert set(arguments) == {*options, "namespace", "arguments"}
    assert set(arguments) >= ASKED
    given = [word for name, option in options.items() for word in (option, "/a" if name == "prefix" else "1")]
    parsed = command_parser().parse_args(["run", *given, "--ros-args", "-r", "__ns:=/tb3_0"])
    assert parsed.ros_args == ["-r", "__ns:=/tb3_0"]


@pytest.mark.parametrize("declared", [of_xml, of_yaml], ids=["xml", "yaml"])
def test_launch_files_in_xml_and_yaml_pass_their_arguments_on(declared: Any) -> None:
    arguments, passed, file = declared()
    known = constants("testudo.launch.py")["ARGUMENTS"]
    assert arguments == {name: known[name] for name in (*ASKED, "arguments")}
    assert passed == {name: f"$(var {name})" for name in arguments}
    shared, _, path = file.partition("/")
    assert shared == "$(find-pkg-share smarttestudo)"
    assert (ROOT / path).is_file()


def test_what_the_turtlebot3_passes_on_is_known_to_both_launch_files() -> None:
    passed = set(constants("turtlebot3.launch.py")["OF_THE_RUN"])
    assert passed <= set(constants("testudo.launch.py")["ARGUMENTS"])
    text = (LAUNCH / "turtlebot3.launch.py").read_text(encoding="utf-8")
    assert all(f'"{name}": (' in text for name in passed)


def ros2(*arguments: str) -> int:
    """``ros2`` with this verb only, as ros2cli adds it and calls it."""
    project = tomli.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    ((name, target),) = project["entry-points"]["ros2cli.command"].items()
    module, _, attribute = target.partition(":")
    extension = getattr(importlib.import_module(module), attribute)()
    parser = argparse.ArgumentParser(prog="ros2")
    verb = parser.add_subparsers().add_parser(name, description=extension.__doc__)
    extension.add_arguments(verb, f"ros2 {name}")
    code: int = extension.main(parser=parser, args=parser.parse_args([name, *arguments]))
    return code


def test_a_verb_of_ros2_is_every_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"begin SetFrequency /odom 10 end")))
    assert ros2("check", "--format", "json", "-") == 0
    assert capsys.readouterr() == ("[]\n", "")
    assert ros2("chek") == 2
    assert capsys.readouterr().err == "COMMAND: error: invalid choice: 'chek'; did you mean check?\n"
    for option, printed in (("--version", f"testudo {__version__}\n"), ("--help", "usage: testudo ")):
        with pytest.raises(SystemExit) as left:
            ros2(option)
        assert left.value.code == 0
        assert capsys.readouterr().out.startswith(printed)


def test_analyzers_take_every_status_of_diagnostics() -> None:
    parameters = YAML(typ="safe").load(ROOT / "extras" / "diagnostic_analyzers.yaml")
    group = parameters["analyzers"]["ros__parameters"]["smarttestudo"]
    node, topics = group["analyzers"]["node"], group["analyzers"]["topics"]
    (of_node, *of_topics) = diagnostics(STATUS)
    assert of_topics
    assert all(part in of_node.name for part in node["contains"])
    assert all(one.name.startswith(tuple(topics["startswith"])) for one in of_topics)
