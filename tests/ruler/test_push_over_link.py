# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler over a link, where ROS cannot be imported: live values, and rules from the page to a real run."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import pytest

from link.zenoh.ends import free_endpoint, refuse_warning
from ros.ros_processes import Process, SmallRobot
from ruler.page_socket import PageSocket, open_socket
from ruler.ruler_server import Answer, Page, served
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.zenoh import open_link_robots
from smarttestudo.link.zenoh.security import LinkOptions

ROBOT = "tb3:/smarttestudo"
IMU = "sensor_msgs/msg/Imu"
RULES = """begin
  SetFrequency /imu 10
  Rule "Far"
  If (CheckValue /odom pose_x > 3) Then
    SetFrequency /imu 20
  EndIf
end
"""
FASTER = RULES.replace("/imu 10", "/imu 25")


def sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


@pytest.fixture
def endpoint() -> str:
    return free_endpoint()


@pytest.fixture
def page(robot: SmallRobot, endpoint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Page]:
    monkeypatch.setitem(sys.modules, "rclpy", None)
    options = LinkOptions(connect=(endpoint,))
    with served(tmp_path, open_robots=partial(open_link_robots, options, refuse_warning)) as page:
        yield page


@pytest.fixture
def runtime(robot: SmallRobot, endpoint: str) -> Process:
    runtime = robot.runtime(RULES, "--link-listen", endpoint, "--robot", "tb3")
    runtime.line_with("Relaying")
    return runtime


def until_heard(socket: PageSocket) -> Any:
    return socket.next("robots", lambda message: any(one["node"] == ROBOT for one in message["robots"]))


def rules_are(origin: str, text: str) -> Any:
    def are(message: Any) -> bool:
        return [(one["rules"]["origin"], one["rules"]["sha256"]) for one in message["robots"]] == [
            (origin, sha256(text))
        ]

    return are


def pushed(page: Page, text: str, path: str = "/api/push") -> Answer:
    return page.post(path, {"node": ROBOT, "text": text, "name": "warehouse.adirf"})


def read(live: Any) -> list[tuple[str, float | None]]:
    """What the checks read."""
    return [(state, value) for block in live["status"]["blocks"] for _, _, state, value in block["checks"]]


def test_every_check_and_topic_is_shown_live_as_often_as_asked(
    robot: SmallRobot, page: Page, runtime: Process
) -> None:
    source = robot.source(imu={"type": IMU, "hz": 40}, odom={"type": "nav_msgs/msg/Odometry", "hz": 20})
    with open_socket(page) as socket:
        until_heard(socket)
        socket.watch(ROBOT, 5.0)
        # The name of the rule is known once the robot was asked for its rules.
        live = socket.next(
            "live",
            lambda live: [value for _, value in read(live)] == [0.0] and all(live["labels"]),
        )
        assert (live["labels"], read(live)) == (["Far"], [("false", 0.0)])
        source.say("move odom")
        socket.next(
            "live",
            lambda live: (
                live["status"]["topics"]["/imu"]["target_hz"] == 20
                and read(live) == [("true", 5.0)]
                and live["status"]["status_hz"] == 5
            ),
        )
        stamps_s = [socket.next("live")["status"]["stamp_ns"] / NS_PER_S for _ in range(20)]
        # Slower on a busy machine, but more than the one a second that comes unasked.
        assert median(after - before for before, after in pairwise(stamps_s)) < 0.5
        live = socket.next("live", lambda live: live["status_kb_per_s"] < 1)
        topics = page.post("/api/vocabulary", {}).json["topics"]
        assert {one["topic"] for one in topics if one["source"] == "robot"} == {"/imu", "/odom"}


@pytest.mark.contract
def test_rules_are_previewed_pushed_and_confirmed(page: Page, runtime: Process) -> None:
    with open_socket(page) as socket:
        until_heard(socket)
        preview = pushed(page, FASTER, "/api/push/preview").json
        assert (preview["same"], preview["differences"]) == (False, ["default: /imu 10 → 25 Hz"])
        assert preview["robot_hash"] == sha256(RULES)
        answer = pushed(page, FASTER).json
        assert (answer["state"], answer["hash"]) == ("staged", sha256(FASTER))
        socket.next("robots", rules_are("waiting", FASTER))
        confirmed = page.post("/api/push/confirm", {"node": ROBOT, "hash": answer["hash"]})
        assert (confirmed.status, confirmed.json["state"]) == (200, "confirmed")
        socket.next("robots", rules_are("pushed", FASTER))
    runtime.line_with("pushed rules confirmed")


def test_rules_that_are_not_confirmed_go_back_and_a_refusal_is_told_in_the_robot_s_words(
    page: Page, runtime: Process
) -> None:
    with open_socket(page) as socket:
        until_heard(socket)
        refused = pushed(page, FASTER.replace("SetFrequency /imu 25", "SetFrequency /testudo/status 1"))
        assert refused.status == 422
        assert "/testudo/status" in refused.error
        answer = pushed(page, FASTER).json
        socket.next("robots", rules_are("waiting", FASTER))
        socket.next("robots", rules_are("files", RULES))
        late = page.post("/api/push/confirm", {"node": ROBOT, "hash": answer["hash"]})
    assert late.status == 422
    assert "they were not confirmed within 10 s" in late.error


def test_a_robot_that_nobody_reaches_is_said_to_be_out_of_reach(page: Page) -> None:
    with open_socket(page) as socket:
        said = socket.next("robots", lambda message: "refused" in (message["problem"] or ""))
        assert said["robots"] == []
        assert said["problem"].endswith("it cannot be reached: Connection refused")
        answer = pushed(page, FASTER)
        assert (answer.status, answer.error) == (404, f"no status of {ROBOT} was received")


def test_kept_rules_are_written_to_the_robot_s_file(robot: SmallRobot, page: Page, endpoint: str) -> None:
    runtime = robot.runtime(RULES, "--allow-writing-rules", "--link-listen", endpoint, "--robot", "tb3")
    runtime.line_with("Relaying")
    path = robot.folder / "rules0.adirf"
    with open_socket(page) as socket:
        until_heard(socket)
        asked = {"node": ROBOT, "hash": pushed(page, FASTER).json["hash"]}
        assert page.post("/api/push/confirm", asked).status == 200
        assert page.post("/api/push/lasting", {"node": ROBOT}).json["writable_file"] == str(path)
        assert page.post("/api/push/write", asked).status == 200
        socket.next("robots", rules_are("files", FASTER))
    assert path.read_text() == FASTER
    assert Path(f"{path}.previous").read_text() == RULES
