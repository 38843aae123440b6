# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a page sees of a real run, over the web socket."""

from __future__ import annotations

import math
import signal
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import pytest
from websockets.exceptions import InvalidStatus

from link.zenoh.ends import until
from ros.ros_processes import SmallRobot
from ruler.page_socket import PageSocket, open_socket
from ruler.ruler_server import TIMEOUT_S, Page, served
from smarttestudo.domain.errors import Extra, how_to_install
from smarttestudo.domain.units import NS_PER_S

NODE = "/smarttestudo"
IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
RULES = """begin
  SetFrequency /imu 10
  Rule "Far"
  If (CheckValue /odom pose_x > 3 AND Not (CheckValue /battery_state level > 20))
  Then SetFrequency /imu 20
  EndIf
end
"""


@pytest.fixture
def page(robot: SmallRobot, tmp_path: Path) -> Iterator[Page]:
    with served(tmp_path) as page:
        yield page


def watched(socket: PageSocket, update_hz: float = 5.0) -> None:
    socket.next("robots", lambda message: any(one["node"] == NODE for one in message["robots"]))
    socket.watch(NODE, update_hz)


def states(live: Any) -> list[tuple[str, str, str, float | None]]:
    return [
        (check["topic"], check["property"], state, value)
        for check, (_, _, state, value) in zip(live["checks"], rows(live), strict=True)
        if check is not None
    ]


def rows(live: Any) -> list[tuple[int, int, str, float | None]]:
    return [tuple(row) for block in live["status"]["blocks"] for row in block["checks"]]


def test_every_check_says_whether_it_holds_and_every_topic_what_it_gets(
    robot: SmallRobot, page: Page
) -> None:
    source = robot.source(imu={"type": IMU, "hz": 40}, odom={"type": ODOMETRY, "hz": 20, "x": 0.0})
    robot.operator(imu={"type": IMU})
    robot.runtime(RULES)
    with open_socket(page) as socket:
        watched(socket)
        battery = ("/battery_state", "level", "unknown", None)
        away = [("/odom", "pose_x", "false", 0.0), battery]
        # The name of the rule is known once the robot was asked for its rules.
        live = socket.next(
            "live",
            lambda live: (
                states(live) == away
                and live["status"]["topics"]["/imu"]["target_hz"] == 10
                and all(live["labels"])
            ),
        )
        (block,) = live["status"]["blocks"]
        assert (live["labels"], block["file"], block["state"]) == (["Far"], 0, "false")
        assert [row[:2] for row in rows(live)] == [(4, 7), (4, 44)]
        assert [(one["op"], one["limit"]) for one in live["checks"]] == [(">", 3), (">", 20)]

        def is_relayed(live: Any) -> bool:
            """As long as its source and that of the check do not stand still."""
            imu = live["status"]["topics"]["/imu"]
            relayed = imu["actual_hz"] and (imu["target_hz"], imu["reason"]) == (10, "default")
            return bool(relayed) and imu["silent"] is None

        live = socket.next("live", is_relayed)
        ((topic, imu),) = live["status"]["topics"].items()
        assert (topic, imu["output"]) == ("/imu", "/testudo/imu")
        source.say("move odom")
        live = socket.next(
            "live",
            lambda live: (
                states(live) == [("/odom", "pose_x", "true", 5.0), battery]
                and live["status"]["topics"]["/imu"]["target_hz"] == 20
            ),
        )
        # In doubt, monitor more: the battery is not known.
        assert live["status"]["blocks"][0]["state"] == "unknown"
        assert live["status"]["topics"]["/imu"]["reason"] == "unknown"
        source.say("hush odom")
        socket.next("live", lambda live: states(live) == [("/odom", "pose_x", "unknown", None), battery])


def mean_hz(stamps_s: list[float]) -> float:
    return (len(stamps_s) - 1) / (stamps_s[-1] - stamps_s[0])


def test_two_pages_have_a_rate_each_and_the_robot_is_left_as_it_was(robot: SmallRobot, page: Page) -> None:
    robot.runtime(RULES)
    remote = robot.remote()
    with open_socket(page) as fast:
        watched(fast, update_hz=20)
        fast.next("live", lambda live: live["status"]["status_hz"] == 20)
        with open_socket(page) as slow:
            watched(slow, update_hz=2)
            fast_s = [fast.next("live")["status"]["stamp_ns"] / NS_PER_S for _ in range(40)]
            slow_s = [slow.next("live")["status"]["stamp_ns"] / NS_PER_S for _ in range(5)]
            assert remote.ask("get", "status_hz") == 20
        # Slower on a busy machine, but never faster than asked for.
        assert mean_hz(slow_s) < 4
        assert mean_hz(fast_s) < 22
        assert median(after - before for before, after in pairwise(fast_s)) < 1 / 4
        assert fast_s == sorted(fast_s)
        fast.watch(None)
        fast.next("robots", lambda _: remote.ask("get", "status_hz") == 1)
    (refused,) = remote.ask("set", {"status_hz": 21.0})
    assert "from 1 to 20" in refused


def test_a_page_of_another_site_sees_nothing_of_a_robot(page: Page) -> None:
    with pytest.raises(InvalidStatus) as refused, open_socket(page, origin="http://evil.example"):
        pass
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize(
    "nonsense",
    [
        "",
        "{",
        "[]",
        '{"kind": "watch"}',
        '{"kind": "watch", "node": 5}',
        '{"kind": "shell"}',
        "[" * 9000,
        "x" * 1_000_000,
        b"\0\1",
        '{"kind": "watch", "node": "/smarttestudo", "update_hz": "fast"}',
    ],
)
def test_what_is_not_understood_costs_only_itself(examples_page: Page, nonsense: str | bytes) -> None:
    with open_socket(examples_page) as socket:
        socket.next("hello")
        socket.connection.send(nonsense)
        socket.watch("/nobody", update_hz=math.pi * 1e300)
        socket.next("robots")
        socket.next("robots")


def live_topics(page: Page) -> list[tuple[str, str]]:
    """What is suggested because robots publish it, with its type."""
    topics = page.post("/api/vocabulary", {}).json["topics"]
    return [(one["topic"], one["type"]) for one in topics if one["source"] == "robot"]


def test_live_topics_are_suggested_and_measured_without_the_rulers_own(robot: SmallRobot, page: Page) -> None:
    robot.source(imu={"type": IMU, "hz": 40})
    # Without rules everything that the robot's own nodes publish is relayed.
    runtime = robot.testudo_run()
    runtime.line_with("/imu: Full (fallback)")
    assert "robot" not in {one["source"] for one in page.post("/api/vocabulary", {}).json["topics"]}
    with open_socket(page) as socket:
        # The last status may be older than the line above.
        said = socket.next("robots", lambda message: [one["topics"] for one in message["robots"]] == [1])
        (seen,) = said["robots"]
        assert (seen["rules"]["origin"], seen["rules"]["sha256"]) == ("fallback", "")
        # The Ruler's node may find the source later than the robot did, and topics before their nodes.
        until(lambda: live_topics(page) == [("/imu", IMU)])
        measured = page.post("/api/profile/measure-live", {"seconds": 5, "run": "m"})
        assert 0 < socket.next("progress")["share"] <= 1
    assert measured.status == 200
    assert '[topics."/imu"]' in measured.json["text"]
    assert measured.json["text"].count("[topics.") == 1
    assert page.post("/api/profile/measure-live", {"seconds": 61}).status == 422


def test_without_ros_the_page_is_told_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)
    with served(tmp_path) as page, open_socket(page) as socket:
        said = socket.next("robots", lambda message: "joined" not in (message["problem"] or ""))
        assert (said["robots"], said["problem"]) == (
            [],
            "this needs ROS 2 (rclpy); source your ROS setup; without a ROS 2 installation, "
            f"{how_to_install(Extra.ROS)}",
        )
        answer = page.post("/api/push", {"node": NODE, "text": RULES})
        assert (answer.status, answer.json["error"]["remedy"]) == (404, said["problem"])
        assert page.post("/api/vocabulary", {}).status == 200


def test_ctrl_c_ends_a_ruler_that_watches_a_robot_without_a_word(robot: SmallRobot, tmp_path: Path) -> None:
    robot.runtime(RULES).line_with("Relaying")
    command = [sys.executable, "-m", "smarttestudo", "ruler", str(tmp_path), "--port", "0", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        port = int(process.stdout.readline().decode().partition("127.0.0.1:")[2].partition("/")[0])
        with open_socket(Page(port=port)) as socket:
            watched(socket)
            socket.next("live")
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=TIMEOUT_S)
    assert (process.returncode, errors) == (0, b"")
