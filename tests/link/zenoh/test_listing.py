# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What ``testudo incidents list --connect`` says of several robots."""

from __future__ import annotations

import json
from contextlib import ExitStack
from pathlib import Path

import pytest

from link.zenoh.ends import free_endpoint, operator_end, refuse_warning, robot_end, until
from link.zenoh.fetched_incidents import NAME, write_incident
from link.zenoh.memory_zenoh import network, virtual_time
from smarttestudo.cli.main import main
from smarttestudo.link.zenoh import open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions

__all__ = ["network", "virtual_time"]
pytestmark = pytest.mark.usefixtures("network", "virtual_time")


def test_a_robot_that_keeps_no_incidents_is_said_and_those_of_others_are_listed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_incident(tmp_path / "bob")
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint, "ada"), robot_end(endpoint, "bob") as bob:
        until(lambda: len(operator.counts()) == 2)
        command = ["incidents", "list", "--connect", endpoint, "--json"]
        assert main(command) == 1
        silent = capsys.readouterr()
        assert silent.out == ""
        bob.offer_incidents(tmp_path / "bob")
        assert main(command) == 0
        listed = capsys.readouterr()
        assert main([*command, "--robot", "ada"]) == 1
    assert "ada does not answer this" in capsys.readouterr().err
    assert main(["incidents", "list", str(tmp_path / "bob"), "--json"]) == 0
    (of_robot,), (in_folder,) = json.loads(listed.out), json.loads(capsys.readouterr().out.splitlines()[-1])
    for key in (
        "incident",
        "label",
        "rule",
        "triggered_ns",
        "from_ns",
        "to_ns",
        "messages",
        "size_bytes",
        "read",
    ):
        assert of_robot[key] == in_folder[key]
    assert [line.partition(";")[0] for line in silent.err.splitlines()] == [
        f"testudo: {robot}: {endpoint}: error: {robot} does not answer this" for robot in ("ada", "bob")
    ]
    assert [one["name"] for one in json.loads(listed.out)] == [NAME]
    assert [line.partition(": ")[2][:5] for line in listed.err.splitlines()] == ["ada: "]


def test_the_robots_of_several_places_are_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    endpoints = {name: free_endpoint() for name in ("ada", "bob")}
    with ExitStack() as opened:
        for name, endpoint in endpoints.items():
            write_incident(tmp_path / name)
            options = LinkOptions(listen=(endpoint,))
            robot = opened.enter_context(open_robot_end(name, options, refuse_warning))
            robot.offer_incidents(tmp_path / name)
        connect = [part for endpoint in endpoints.values() for part in ("--connect", endpoint)]
        assert main(["incidents", "list", *connect, "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [(one["robot"], one["name"]) for one in listed] == [("ada", NAME), ("bob", NAME)]
