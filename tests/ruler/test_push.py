# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules from the page to a real ``testudo run``, over HTTP, ROS parameters and back to a real subscriber."""

from __future__ import annotations

import hashlib
import signal
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from ros.ros_processes import Process, SmallRobot
from ruler.page_socket import PageSocket, open_socket
from ruler.ruler_server import Answer, Page, served

NODE = "/smarttestudo"
PAUSE_S = 0.35
IMU = "sensor_msgs/msg/Imu"
RULES = """// The rules of the robot's own file.
begin
  SetFrequency /imu 10

  // Between the racks.
  Rule "Corridor"
  If (CheckValue /odom pose_x > 1) Then
    SetFrequency /imu 4
  EndIf
  Rule "Far"
  If (CheckValue /odom pose_x > 50) Then
    SetFrequency /imu 2
  EndIf
end
"""
# The same blocks in another order, with other comments, layout and spellings.
MOVED = """begin
  Rule "Far" If (CheckValue /odom pose_x > 50.0) Then SetFrequency /imu 2.0 Hz EndIf
  Rule "Corridor" If ((CheckValue /odom pose_x > 1)) Then
    SetFrequency /imu 4   // slowly
  EndIf
  SetFrequency /imu 10
end
"""
FASTER = RULES.replace("/imu 10", "/imu 25")


def sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


@pytest.fixture
def page(robot: SmallRobot, tmp_path: Path) -> Iterator[Page]:
    with served(tmp_path) as page:
        yield page


@pytest.fixture
def runtime(robot: SmallRobot) -> Process:
    runtime = robot.runtime(RULES)
    runtime.line_with("Relaying")
    return runtime


def is_there(message: Any) -> bool:
    return any(one["node"] == NODE for one in message["robots"])


def until_heard(socket: PageSocket) -> Any:
    return socket.next("robots", is_there)["robots"][0]


def pushed(page: Page, text: str, path: str = "/api/push", **more: object) -> Answer:
    return page.post(path, {"node": NODE, "text": text, "name": "warehouse.adirf", **more})


def rate_hz(arrivals: list[Any], last: int) -> float:
    """By when the messages were due at the source; pauses, in which a machine stood still, do not count."""
    due_s = [due_s for _, _, due_s in arrivals[-last:]]
    gaps_s = [gap_s for gap_s in (after - before for before, after in pairwise(due_s)) if gap_s < PAUSE_S]
    return float(len(gaps_s) / sum(gaps_s))


def test_a_push_changes_the_rate_that_a_subscriber_measures_and_stays_once_confirmed(
    robot: SmallRobot, page: Page, runtime: Process
) -> None:
    robot.source(imu={"type": IMU, "hz": 60}, odom={"type": "nav_msgs/msg/Odometry", "hz": 20})
    operator = robot.operator(span_s=2.0, imu={"type": IMU})
    # Long enough that a message which a busy machine loses does not tell.
    operator.line_with("heard 3")
    before_hz = rate_hz(operator.result("result")["imu"], 50)
    with open_socket(page) as socket:
        seen = until_heard(socket)
        assert (seen["is_heard"], seen["rules"]["origin"], seen["rules"]["sha256"]) == (
            True,
            "files",
            sha256(RULES),
        )
        preview = pushed(page, FASTER, "/api/push/preview").json
        assert (preview["same"], preview["differences"]) == (False, ["default: /imu 10 → 25 Hz"])
        assert (preview["text_to_send"], preview["hash"]) == (FASTER, sha256(FASTER))
        answer = pushed(page, FASTER).json
        assert (answer["state"], answer["hash"], answer["confirm_within_s"]) == ("staged", sha256(FASTER), 10)
        waiting = socket.next("robots", lambda message: message["robots"][0]["rules"]["origin"] == "waiting")
        assert 0 < waiting["robots"][0]["rules"]["waits_s"] <= 10
        confirmed = page.post("/api/push/confirm", {"node": NODE, "hash": answer["hash"]})
        assert (confirmed.status, confirmed.json["state"]) == (200, "confirmed")
        socket.next("robots", lambda message: message["robots"][0]["rules"]["origin"] == "pushed")
    runtime.line_with("pushed rules confirmed")
    operator.result("result")
    for _ in range(3):
        operator.line_with("heard")
    after_hz = rate_hz(operator.result()["imu"], 100)
    # How exact rates are is shown elsewhere, on a calm machine.
    assert before_hz == pytest.approx(10, rel=0.2)
    assert after_hz == pytest.approx(25, rel=0.2)


def test_rules_with_errors_do_not_leave_and_the_robots_own_refusal_is_told_in_its_words(
    page: Page, runtime: Process
) -> None:
    with open_socket(page) as socket:
        until_heard(socket)
        broken = pushed(page, RULES.replace("/imu 4", "/imu fast"))
        assert broken.status == 409
        assert broken.json["error"]["findings"][0]["line"] == 8
        # The server does not know how the robot names what it relays; the robot does.
        clash = RULES.replace("SetFrequency /imu 10", "SetFrequency /imu 10 SetFrequency /testudo/imu 1")
        refused = pushed(page, clash)
        assert refused.status == 422
        assert "/testudo/imu" in refused.error
        seen = until_heard(socket)
        assert (seen["rules"]["origin"], seen["rules"]["sha256"]) == ("files", sha256(RULES))
        assert pushed(page, RULES, "/api/push/preview").json["same"]
    assert not any("rules pushed" in line for line in runtime.output)


def test_rules_that_are_not_confirmed_go_back_by_themselves_and_that_is_said(
    page: Page, runtime: Process
) -> None:
    with open_socket(page) as socket:
        until_heard(socket)
        answer = pushed(page, FASTER).json
        socket.next("robots", lambda message: message["robots"][0]["rules"]["origin"] == "waiting")
        runtime.line_with("pushed rules not confirmed within 10 s")
        socket.next("robots", lambda message: message["robots"][0]["rules"]["sha256"] == sha256(RULES))
        late = page.post("/api/push/confirm", {"node": NODE, "hash": answer["hash"]})
    assert late.status == 422
    assert "no longer in force: they were not confirmed within 10 s" in late.error


def test_what_a_robot_could_not_tell_apart_is_not_sent(page: Page, runtime: Process) -> None:
    with open_socket(page) as socket:
        until_heard(socket)
        for text in (RULES, MOVED):
            preview = pushed(page, text, "/api/push/preview").json
            assert (preview["same"], preview["differences"]) == (True, [])
            answer = pushed(page, text).json
            assert (answer["state"], answer["hash"]) == ("same", sha256(RULES))
        renamed = pushed(page, RULES.replace('"Far"', '"Afar"'), "/api/push/preview").json
        assert renamed["differences"] == ["Far: removed", "Afar: added"]
    assert not any("rules pushed" in line for line in runtime.output)


def test_levels_go_to_the_robot_as_the_rates_that_they_mean(page: Page, runtime: Process) -> None:
    profile = (
        'budget_kb_per_s = 100.0\n[topics."/imu"]\nmessage_kb = 0.32\ntiers_hz = [5, 10, 20, 30, 40, 50]\n'
    )
    text = RULES.replace("SetFrequency /imu 10", "SetFrequency /imu Desirable")
    with open_socket(page) as socket:
        until_heard(socket)
        assert pushed(page, text).status == 409
        preview = pushed(page, text, "/api/push/preview", profile_text=profile).json
        assert "Desirable" not in preview["text_to_send"]
        assert pushed(page, text, profile_text=profile).json["state"] == "staged"
        socket.next("robots", lambda message: message["robots"][0]["rules"]["sha256"] == preview["hash"])


def test_a_robot_that_was_killed_is_said_to_be_silent(page: Page, runtime: Process) -> None:
    with open_socket(page) as socket:
        until_heard(socket)
        runtime.signal(signal.SIGKILL)
        runtime.exit_code()
        answer = pushed(page, FASTER)
        assert answer.status == 504
        assert answer.error == "the node did not answer within 5 s"
        assert "testudo run" in answer.json["error"]["remedy"]
        confirmed = page.post("/api/push/confirm", {"node": NODE, "hash": sha256(FASTER)})
        assert confirmed.status == 504
        socket.next("robots", lambda message: not message["robots"][0]["is_heard"])


def test_nothing_is_asked_of_a_node_that_never_spoke(page: Page) -> None:
    for path in ("/api/push", "/api/push/preview"):
        answer = page.post(path, {"node": "/stranger", "text": RULES})
        assert (answer.status, answer.error) == (404, "no status of /stranger was received")


def test_kept_rules_are_written_to_the_file_of_a_robot_that_lets_them(robot: SmallRobot, page: Page) -> None:
    runtime = robot.runtime(RULES, "--allow-writing-rules")
    runtime.line_with("Relaying")
    path = robot.folder / "rules0.adirf"
    with open_socket(page) as socket:
        until_heard(socket)
        lasting = page.post("/api/push/lasting", {"node": NODE}).json
        assert lasting == {"files": [str(path)], "writable_file": str(path), "why_not": ""}
        asked = {"node": NODE, "hash": pushed(page, FASTER).json["hash"]}
        early = page.post("/api/push/write", asked)
        assert (early.status, "confirmed rules" in early.error) == (422, True)
        assert page.post("/api/push/confirm", asked).status == 200
        written = page.post("/api/push/write", asked)
        assert written.json == {"file": str(path), "previous_file": f"{path}.previous"}
        socket.next("robots", lambda message: message["robots"][0]["rules"]["origin"] == "files")
    runtime.line_with("pushed rules written to")
    assert path.read_text() == FASTER
    assert Path(f"{path}.previous").read_text() == RULES
    runtime.end()
    again = robot.testudo("run", "--rules", str(path))
    again.line_with("/imu: 25 Hz (default)")


def test_a_robot_that_does_not_let_its_file_be_written_says_so(page: Page, runtime: Process) -> None:
    with open_socket(page) as socket:
        until_heard(socket)
        lasting = page.post("/api/push/lasting", {"node": NODE}).json
        assert (lasting["writable_file"], "--allow-writing-rules" in lasting["why_not"]) == ("", True)
        asked = {"node": NODE, "hash": pushed(page, FASTER).json["hash"]}
        assert page.post("/api/push/confirm", asked).status == 200
        refused = page.post("/api/push/write", asked)
        assert (refused.status, "--allow-writing-rules" in refused.error) == (422, True)


def test_a_file_that_changed_under_the_robot_is_not_overwritten(robot: SmallRobot, page: Page) -> None:
    runtime = robot.runtime(RULES, "--allow-writing-rules")
    runtime.line_with("Relaying")
    path = robot.folder / "rules0.adirf"
    with open_socket(page) as socket:
        until_heard(socket)
        asked = {"node": NODE, "hash": pushed(page, FASTER).json["hash"]}
        assert page.post("/api/push/confirm", asked).status == 200
        # Somebody on the robot writes at it and is not done: pushed rules stay in force.
        path.write_text("begin SetFrequency /im", encoding="utf-8")
        runtime.line_with("the last valid rules stay in force")
        refused = page.post("/api/push/write", asked)
        assert (refused.status, "changed since it was loaded" in refused.error) == (422, True)
    assert path.read_text() == "begin SetFrequency /im"
    assert not Path(f"{path}.previous").exists()
