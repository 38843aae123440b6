# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What testudo echo hears and shows, in virtual time."""

from __future__ import annotations

import io
import json
from array import array
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robot.status.virtual_robot import Source, VirtualRobot
from smarttestudo.cli.echo import cropped, echo_block, echo_json, echo_line, live_lines, message_block
from smarttestudo.cli.main import main
from smarttestudo.robot.echo import Bounds, Echo, EchoedTopic, message_values, no_message_error

ODOMETRY = "nav_msgs/msg/Odometry"
WAITS_PER_S = 50
ECHO = Echo(
    topic="/odom",
    type_name=ODOMETRY,
    messages=1200,
    rate_hz=4.0,
    kb_per_s=2.896,
    size_bytes=724,
    values={
        "header": {"frame_id": "odom"},
        "pose": {"x": 5.87, "valid": True},
        "ranges": [0.5, float("inf"), "… 358 more"],
        "transforms": [{"name": "a"}, {"name": ""}, "… 3 more"],
    },
)


class Message(SimpleNamespace):
    """As the messages of rclpy are."""

    def get_fields_and_field_types(self) -> dict[str, str]:
        return dict.fromkeys(vars(self), "")


def echoed(robot: VirtualRobot, topic: str, *fields: str, keep: int = 0) -> EchoedTopic:
    return EchoedTopic(robot, topic, fields=fields, bounds=Bounds(), keep=keep)


def heard_for(robot: VirtualRobot, topic: EchoedTopic, seconds: int) -> Echo:
    echo = topic.echo()
    for _ in range(seconds):
        topic.poll()
        for _ in range(WAITS_PER_S):
            robot.wait(None, 1 / WAITS_PER_S)
        echo = topic.echo()
    return echo


def values_of(message: object, *fields: str, bounds: Bounds | None = None) -> Any:
    return message_values(message, ODOMETRY, fields, bounds or Bounds(items=2, characters=10))


def test_rate_bandwidth_and_count_are_those_of_the_messages() -> None:
    robot = VirtualRobot(sources={"/imu": Source(hz=50)})
    echo = heard_for(robot, echoed(robot, "/imu"), 5)
    assert (echo.messages, echo.size_bytes) == (250, 250)
    assert echo.rate_hz == pytest.approx(50, rel=0.01)
    assert echo.kb_per_s == pytest.approx(12.5, rel=0.01)


def test_what_queued_up_before_the_start_does_not_count_as_a_rate() -> None:
    robot = VirtualRobot(sources={"/imu": Source(hz=10)})
    topic = echoed(robot, "/imu")
    topic.poll()
    for _ in range(40):
        robot.say("/imu", "a burst")
    assert topic.echo().rate_hz is None
    assert heard_for(robot, topic, 5).rate_hz == pytest.approx(10, rel=0.01)


def test_what_queued_up_while_the_machine_was_slow_does_not_count_as_a_rate() -> None:
    robot = VirtualRobot(sources={"/imu": Source(hz=1e-9)})
    topic = echoed(robot, "/imu")
    topic.poll()
    robot.say("/imu", "the first")
    robot.wait(None, 0.8)
    for _ in range(18):
        robot.say("/imu", "a burst")
        robot.wait(None, 2e-5)
    echo = topic.echo()
    assert (echo.messages, echo.rate_hz, echo.kb_per_s) == (19, None, 0.0)
    robot.sources["/imu"] = Source(from_s=0.8, hz=10)
    assert heard_for(robot, topic, 5).rate_hz == pytest.approx(10, rel=0.03)


def test_a_topic_that_falls_silent_has_a_rate_of_0() -> None:
    robot = VirtualRobot(sources={"/imu": Source(hz=50)})
    topic = echoed(robot, "/imu")
    heard_for(robot, topic, 5)
    robot.sources["/imu"].hz = 1e-9
    assert heard_for(robot, topic, 5).rate_hz == 0.0


def test_it_waits_for_a_publisher_and_then_for_a_message() -> None:
    robot = VirtualRobot(sources={"/imu": Source(from_s=2, hz=0.2)})
    topic = echoed(robot, "/imu")
    assert heard_for(robot, topic, 2).state == "waiting for a publisher"
    assert heard_for(robot, topic, 2).state == "waiting for a message"
    assert heard_for(robot, topic, 10).state == ""
    del robot.sources["/imu"]
    topic.poll()
    assert topic.state == "no publisher left"


def test_the_values_asked_for_are_those_of_the_last_message() -> None:
    robot = VirtualRobot(sources={"/name": Source(type_name="std_msgs/msg/String", hz=1e-9)})
    topic = echoed(robot, "/name", "data", keep=2)
    topic.poll()
    for text in ("first", "second", "third"):
        robot.say("/name", text)
    assert topic.echo().values == {"data": "third"}
    kept = [(echo.messages, echo.values) for echo in topic.take_kept()]
    assert kept == [(1, {"data": "first"}), (2, {"data": "second"})]
    assert topic.take_kept() == []


def test_of_latched_messages_from_before_the_newest_are_kept() -> None:
    source = Source(type_name="std_msgs/msg/String")
    robot = VirtualRobot(sources={"/decisions": source})
    topic = echoed(robot, "/decisions", "data", keep=2)
    topic.poll()
    for number in range(100):
        robot.say("/decisions", f"{number}")
        robot.wait(None, 0.001)
        assert topic.take_kept() == []
    robot.wait(None, 0.5)
    assert [echo.values for echo in topic.take_kept()] == [{"data": "98"}, {"data": "99"}]
    robot.say("/decisions", "new")
    assert topic.take_kept() == []


def test_latched_messages_that_go_on_and_on_are_shown() -> None:
    source = Source(type_name="std_msgs/msg/String")
    robot = VirtualRobot(sources={"/state": source})
    topic = echoed(robot, "/state", "data", keep=1)
    topic.poll()
    for number in range(40):
        robot.say("/state", f"{number}")
        robot.wait(None, 0.05)
    assert len(topic.take_kept()) == 1


def test_fields_that_no_message_has_are_said() -> None:
    robot = VirtualRobot(sources={"/name": Source(type_name="std_msgs/msg/String")})
    topic = echoed(robot, "/name", "date")
    topic.poll()
    robot.say("/name", "first")
    echo = topic.echo()
    assert echo.values == {"date": None}
    assert echo.state.startswith("nothing at date: std_msgs/msg/String has ")


def test_a_type_that_is_not_installed_is_an_error_of_its_topic() -> None:
    robot = VirtualRobot(
        sources={"/arm": Source(type_name="arm/msg/State")}, missing_types=frozenset({"arm/msg/State"})
    )
    topic = echoed(robot, "/arm")
    topic.poll()
    assert topic.state == "the message type arm/msg/State is not installed"
    assert no_message_error(robot, topic, 5) is topic.error


@pytest.mark.parametrize(
    ("topic", "said"),
    [
        ("/odm", "/odm: error: nobody published it within 5 s; did you mean /odom?"),
        ("/scan", "/scan: error: nobody published it within 5 s; did you mean /testudo/front/scan?"),
        (
            "/zzz",
            "/zzz: error: nobody published it within 5 s; "
            "there are /battery, /odom, /testudo/front/scan and 1 more",
        ),
        ("/battery", "/battery: error: no message came within 5 s; wait longer"),
    ],
)
def test_who_waited_in_vain_is_told_what_else_there_is(topic: str, said: str) -> None:
    names = ("/odom", "/testudo/front/scan", "/battery", "/tf", "/rosout", "/_hidden/odm")
    robot = VirtualRobot(sources={name: Source() for name in names})
    assert str(no_message_error(robot, echoed(robot, topic), 5)) == said


def test_on_an_empty_graph_that_is_said() -> None:
    error = no_message_error(VirtualRobot(), echoed(VirtualRobot(), "/odom"), 5)
    assert "no other topic is published either" in str(error)


def test_long_arrays_and_texts_are_shown_as_far_as_asked() -> None:
    message = Message(
        ranges=array("f", [0.5] * 360),
        covariance=np.array([1.0, 0.0, 2.0]),
        flags=np.array([1, 2], dtype=np.uint8),
        name="abcdefghijklm",
        raw=b"\x07",
        parts=[Message(x=1), Message(x=2), Message(x=3)],
    )
    assert values_of(message) == {
        "ranges": [0.5, 0.5, "… 358 more"],
        "covariance": [1.0, 0.0, "… 1 more"],
        "flags": [1, 2],
        "name": "abcdefghij… 3 more characters",
        "raw": 7,
        "parts": [{"x": 1}, {"x": 2}, "… 1 more"],
    }
    whole = values_of(message, bounds=Bounds(items=None, characters=None))
    assert len(whole["ranges"]) == 360
    assert whole["name"] == "abcdefghijklm"


def test_fields_are_properties_or_paths_to_anything() -> None:
    pose = Message(position=Message(x=1.5, y=2.0, z=0.0), orientation=Message(x=0.0, y=0.0, z=0.0, w=1.0))
    message = Message(pose=Message(pose=pose), frame="odom", ranges=[1, 2])
    assert values_of(message, "pose_x", "frame", "pose.pose.position", "ranges[1]", "ranges[9]", "no") == {
        "pose_x": 1.5,
        "frame": "odom",
        "pose.pose.position": {"x": 1.5, "y": 2.0, "z": 0.0},
        "ranges[1]": 2,
        "ranges[9]": None,
        "no": None,
    }


def test_a_terminal_shows_each_value_on_a_line_by_the_path_that_fields_takes() -> None:
    assert echo_block(ECHO) == [
        "/odom  4.00 Hz  2.9 KB/s  1 200 messages",
        "  header.frame_id: odom",
        "  pose.x: 5.87",
        "  pose.valid: true",
        "  ranges: [0.5, inf, … 358 more]",
        "  transforms[0].name: a",
        '  transforms[1].name: ""',
        "  transforms: … 3 more",
    ]


def test_a_pipe_gets_one_line_with_the_first_values_after_the_header() -> None:
    line = echo_line(ECHO, with_all=False)
    assert line.startswith("/odom  4.00 Hz  2.9 KB/s  1 200 messages  pose.x: 5.87  pose.valid: true")
    assert "header.frame_id: odom" in echo_line(ECHO, with_all=True)


def test_a_single_message_begins_with_its_topic_type_number_and_size() -> None:
    assert message_block(ECHO)[:2] == [f"/odom  {ODOMETRY}  message 1 200  724 B", "header.frame_id: odom"]


def test_json_has_null_for_what_is_no_number() -> None:
    shown = json.loads(echo_json(ECHO))
    assert shown["values"]["ranges"] == [0.5, None, "… 358 more"]
    assert (shown["messages"], shown["rate_hz"], shown["kb_per_s"]) == (1200, 4.0, 2.896)


def test_texts_from_the_network_cannot_move_the_cursor() -> None:
    hostile = Echo(
        topic="/\x1b[2J",
        type_name="a\rb",
        messages=1,
        rate_hz=None,
        kb_per_s=0.0,
        size_bytes=1,
        values={"data": "\x1b[31m\n", "list": ["\r"]},
        state="\x07",
    )
    lines = [*echo_block(hostile), echo_line(hostile, with_all=True), *message_block(hostile)]
    terminal = io.StringIO()
    live_lines(terminal)(lines)
    written = terminal.getvalue().removesuffix("\x1b[J").split("\x1b[K")
    assert [line[-1] for line in written[1:]] == ["\n"] * len(lines)
    assert all(line[:-1].isprintable() for line in written[1:])


def test_a_terminal_shows_the_new_lines_in_place_of_the_former(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("LINES", "24")
    terminal = io.StringIO()
    show = live_lines(terminal)
    show(["a", "b"])
    show(["c"])
    assert terminal.getvalue().replace("\x1b[K", "").split("\x1b[J") == ["a\nb\n", "\x1b[2A\rc\n", ""]


def test_lines_are_cut_to_the_window() -> None:
    lines = cropped(["x" * 100, "b", "c", "d"], 20, 4)
    assert lines == ["x" * 18 + "…", "b", "… 2 more lines: a taller window, or --fields"[:18] + "…"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["/a b"], "'/a b' is not a topic's name"),
        (["/odom", "--fields", "pose..x"], "--fields: error: 'pose..x' is not a field"),
    ],
)
def test_names_that_cannot_be_are_refused_at_once(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["echo", *arguments]) == 2
    assert said in capsys.readouterr().err


def test_a_count_is_a_whole_number_above_0(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["echo", "/odom", "--count", "0"]) == 2
    assert "a whole number above 0, not '0'" in capsys.readouterr().err
