# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The demo across a link between two network namespaces."""

from __future__ import annotations

import json
import signal
import time

import pytest

from ros.ros_processes import LINE_TIMEOUT_S, Process, SmallRobot
from ros.test_demo_live import LIVE_TOPICS, messages_of
from smarttestudo.bags.reader import open_recording
from smarttestudo.demo.network_namespaces import ThinLink
from thin_links import link, namespaces

__all__ = ["link"]
DRIVES_S = 600.0


def namespaces_of(demo: Process) -> list[str]:
    """Those that it has made and not removed; other programs may have theirs."""
    return [name for name in namespaces() if name.endswith(f"-{demo.pid}")]


def test_three_contenders_bring_the_same_drive_across_the_link(link: ThinLink, robot: SmallRobot) -> None:
    out = robot.folder / "out"
    demo = robot.testudo("demo", "--link", "2mbit", "--seconds", "7", "--out", str(out))
    # It says nothing while three of them drive, one after the other.
    demo.line_with("Rate at the operator", within_s=DRIVES_S)
    assert demo.line_with("Topic").split()[1:] == ["Published", "SmartTestudo", "Zenoh", "Fast", "DDS"]
    received_hz = demo.line_with("/odom").split()[2:]
    assert demo.exit_code() == 0, "".join(demo.output)
    assert [0 < float(rate_hz) < 15 for rate_hz in received_hz] == 3 * [True], "".join(demo.output)
    assert "was not measured" not in "".join(demo.output)
    published, received = (messages_of(out / name) for name in ("baseline", "adaptive"))
    assert {topic for topic, count in published.items() if count} >= LIVE_TOPICS
    assert {topic for topic, count in received.items() if count} >= {*LIVE_TOPICS, "/testudo/status"}
    with open_recording(out / "adaptive") as recording:
        assert recording.end_ns > recording.start_ns
    assert json.loads((out / "demo.json").read_text("utf-8"))["link_bit_per_s"] == 2e6
    assert (out / "report.html").is_file()
    assert not namespaces_of(demo)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_neither_namespaces_nor_a_folder(
    link: ThinLink, robot: SmallRobot, number: signal.Signals
) -> None:
    out = robot.folder / "out"
    demo = robot.testudo("demo", "--link", "2mbit", "--out", str(out))
    end_s = time.monotonic() + LINE_TIMEOUT_S
    while len(namespaces_of(demo)) < 2:
        assert time.monotonic() < end_s
        time.sleep(0.05)
    demo.signal(number)
    assert demo.exit_code() == (130 if number is signal.SIGINT else 143)
    assert not namespaces_of(demo)
    assert list(robot.folder.glob("*out*")) == []
    assert "Traceback" not in "".join(demo.output)
