# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What ``testudo incidents list --connect`` says of several robots."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from link.zenoh.ends import free_endpoint, operator_end, robot_end, until
from link.zenoh.test_fetching import NAME, write_incident
from smarttestudo.cli.main import main

pytestmark = pytest.mark.process


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
    assert [line.partition(";")[0] for line in silent.err.splitlines()] == [
        f"testudo: {robot}: {endpoint}: error: {robot} does not answer this" for robot in ("ada", "bob")
    ]
    assert [one["name"] for one in json.loads(listed.out)] == [NAME]
    assert [line.partition(": ")[2][:5] for line in listed.err.splitlines()] == ["ada: "]
    assert "ada does not answer this" in capsys.readouterr().err
