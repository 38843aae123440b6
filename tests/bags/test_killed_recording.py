# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo receive --record`` that is killed, and what can be read then."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from bags.bag_factory import odometry
from bags.bag_reading import read_bag
from link.zenoh.ends import ODOM, free_endpoint, robot_end, until
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import RecordingError

pytestmark = pytest.mark.full
MESSAGES = 10
WITHIN_S = 120.0


def test_of_a_receiver_that_is_killed_all_that_came_is_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    endpoint, folder = free_endpoint(), tmp_path / "drive"
    receive = ["receive", "--listen", endpoint, "--no-ros", "--record", str(folder)]
    environment = {name: value for name, value in os.environ.items() if name != "JOURNAL_STREAM"}
    left = folder / ".r1.partial"
    sent = [odometry(float(number), 0.0) for number in range(MESSAGES)]

    def recorded() -> list[bytes]:
        try:
            return [message.payload for message in read_bag(left).messages]
        except RecordingError:
            return []

    with (
        subprocess.Popen(
            [sys.executable, "-m", "smarttestudo", *receive],
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        ) as process,
        robot_end(endpoint, warn=lambda _: None) as robot,
    ):
        try:
            publisher = robot.advertise(ODOM)
            for payload in sent:
                # Nothing but this one comes, so it does not wait for others.
                until(
                    lambda: recorded()[-1:] == [payload],  # noqa: B023
                    lambda: publisher.publish(payload),  # noqa: B023
                    within_s=WITHIN_S,
                )
        finally:
            process.kill()
        assert process.stdout is not None
        said = process.stdout.read().splitlines()
    assert list(dict.fromkeys(recorded())) == sent
    time = r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3} UTC  "
    assert re.sub(time, "TIME ", "\n".join(said)).splitlines() == [
        f"Receiving at {endpoint}",
        "TIME r1: connected",
        f"TIME r1: recording into {left} until the end, then {folder / 'r1'}",
        "TIME r1: sends /odom (nav_msgs/msg/Odometry)",
    ]
    assert main(["bag", "info", "--json", str(left)]) == 0
    assert json.loads(capsys.readouterr().out)["topics"]["/odom"]["messages"] == len(recorded())
