# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator gets and is shown of robots, from the events of the operator's end."""

from __future__ import annotations

from dataclasses import replace

from link.zenoh.ends import MAP, ODOM
from smarttestudo.cli.receive import reception_lines
from smarttestudo.cli.top_table import Line, Style
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.link.receive.reception import Reception
from smarttestudo.link.zenoh.arrivals import LinkEvent, RobotPresence, StreamSaid

MS = 1_000_000
SECOND = 1_000_000_000


class Notes:
    """A sink that keeps what it is given."""

    def __init__(self) -> None:
        self.opened: list[tuple[str, StreamInfo]] = []
        self.forgotten: list[tuple[str, StreamInfo]] = []
        self.taken: list[ReceivedMessage] = []

    def open(self, robot: str, stream: StreamInfo) -> None:
        self.opened.append((robot, stream))

    def write(self, message: ReceivedMessage) -> None:
        self.taken.append(message)

    def forget(self, robot: str, stream: StreamInfo) -> None:
        self.forgotten.append((robot, stream))

    def close(self) -> None:
        raise AssertionError("whoever made a sink closes it")


def presence(robot: str = "ada", boot: str = "0", *, is_present: bool = True) -> RobotPresence:
    return RobotPresence(robot=robot, boot=boot, is_present=is_present)


def said(info: StreamInfo | None, robot: str = "ada", boot: str = "0", number: int = 0) -> StreamSaid:
    return StreamSaid(robot=robot, boot=boot, number=number, info=info)


def message(
    stream: StreamInfo = ODOM, robot: str = "ada", size_bytes: int = 100, age_ns: int | None = None
) -> ReceivedMessage:
    payload = bytes(size_bytes)
    return ReceivedMessage(robot=robot, stream=stream, payload=payload, offered_ns=1, age_ns=age_ns)


def steady(reception: Reception, hz: int, seconds: int, size_bytes: int = 1000, robot: str = "ada") -> None:
    """``/odom`` at ``hz`` from time 0 on, and a look each second."""
    for number in range(hz * seconds + 1):
        now_ns = number * SECOND // hz
        reception.handle(message(robot=robot, size_bytes=size_bytes), now_ns)
        if number % hz == 0:
            reception.measure(now_ns)


def shown(reception: Reception, width: int | None = None) -> list[str]:
    return [line.text.rstrip() for line in reception_lines(reception, width)]


def line_of(reception: Reception, beginning: str) -> Line:
    (line,) = (line for line in reception_lines(reception) if line.text.startswith(beginning))
    return line


def test_every_sink_gets_streams_and_messages_in_order_and_nothing_of_presence() -> None:
    first, second = Notes(), Notes()
    reception = Reception([first, second])
    other = replace(ODOM, publisher=1)
    messages = [message(), message(other), message(MAP), message()]
    streams = [said(one, number=number) for number, one in enumerate((ODOM, other, MAP))]
    events: list[LinkEvent] = [presence(), *streams, *messages, said(None, number=1)]
    for event in events:
        reception.handle(event, 0)
    for sink in (first, second):
        assert sink.opened == [("ada", ODOM), ("ada", other), ("ada", MAP)]
        assert sink.forgotten == [("ada", other)]
        assert sink.taken == messages


def test_a_stream_whose_number_has_another_one_now_is_forgotten() -> None:
    sink = Notes()
    reception = Reception([sink])
    again = replace(MAP, publisher=1)
    for event in (presence(), said(MAP), said(replace(MAP, definition="x")), said(again)):
        reception.handle(event, 0)
    assert sink.forgotten == [("ada", replace(MAP, definition="x"))]
    assert sink.opened[-1] == ("ada", again)


def test_what_a_robot_has_of_a_publisher_under_another_number_is_kept_until_that_is_closed_too() -> None:
    sink = Notes()
    reception = Reception([sink])
    for event in (presence(), said(MAP), said(MAP, number=1), said(None)):
        reception.handle(event, 0)
    assert sink.forgotten == []
    reception.handle(said(None, number=1), 0)
    assert sink.forgotten == [("ada", MAP)]


def test_streams_of_a_robot_that_left_are_kept_until_another_run_of_it_is_there() -> None:
    for left_first in (True, False):
        sink = Notes()
        reception = Reception([sink])
        for event in (presence(), said(MAP), presence("bob"), said(ODOM, "bob")):
            reception.handle(event, 0)
        # An outage: the same run comes back.
        for is_present in (False, True):
            reception.handle(presence(is_present=is_present), 1)
        leaves, comes = presence(is_present=False), presence(boot="1")
        for event in (leaves, comes) if left_first else (comes, leaves):
            assert sink.forgotten == []
            reception.handle(event, 2)
        assert sink.forgotten == [("ada", MAP)]
        reception.handle(said(MAP, boot="1"), 3)
        assert sink.opened[-1] == ("ada", MAP)


def test_a_stream_that_changed_is_opened_again_and_shown_with_its_new_type() -> None:
    sink = Notes()
    reception = Reception([sink])
    changed = replace(ODOM, type_name="nav_msgs/msg/Path")
    for event in (presence(), said(ODOM), said(changed)):
        reception.handle(event, 0)
    assert sink.opened == [("ada", ODOM), ("ada", changed)]
    assert shown(reception)[-1].endswith(" nav_msgs/msg/Path")


def test_rates_bandwidth_and_counts_are_those_of_what_arrived() -> None:
    reception = Reception([])
    reception.handle(presence(), 0)
    steady(reception, hz=20, seconds=5)
    topic = reception.robots["ada"].topics["/odom"]
    assert (topic.meter.rate_hz, topic.flow.messages) == (20.0, 101)
    assert topic.meter.kb_per_s == 20.0
    assert shown(reception)[0] == "ada   20.0 KB/s of messages"
    assert line_of(reception, "/odom").text.split() == ["/odom", "20.00", "20.0", "–", "101", ODOM.type_name]


def test_publishers_of_one_topic_are_shown_as_one_topic() -> None:
    reception = Reception([])
    for publisher in range(2):
        reception.handle(message(replace(MAP, publisher=publisher)), 0)
    assert reception.robots["ada"].topics["/map"].flow.messages == 2


def test_the_age_is_that_of_the_last_message_and_unknown_where_clocks_cannot_be_compared() -> None:
    reception = Reception([])
    reception.handle(presence(), 0)
    reception.handle(message(age_ns=120 * MS), 0)
    reception.handle(message(age_ns=35 * MS), 1)
    assert reception.robots["ada"].topics["/odom"].age_ms == 35.0
    assert line_of(reception, "/odom").text.split()[3] == "35"
    reception.handle(message(), 2)
    assert line_of(reception, "/odom").text.split()[3] == "–"


def test_a_topic_that_fell_silent_has_rate_0_and_the_look_of_stale_values() -> None:
    reception = Reception([])
    reception.handle(presence(), 0)
    steady(reception, hz=20, seconds=5)
    assert line_of(reception, "/odom").style is Style.PLAIN
    reception.measure(15 * SECOND)
    line = line_of(reception, "/odom")
    assert (line.style, line.text.split()[1]) == (Style.STALE, "0.00")


def test_while_no_robot_came_it_says_what_to_start() -> None:
    (line,) = reception_lines(Reception([]))
    assert (line.style, "testudo run --link" in line.text) == (Style.QUIET, True)


def test_a_robot_that_is_gone_keeps_its_topics_and_is_not_connected_until_it_is_back() -> None:
    reception = Reception([])
    for event in (presence(), message(), presence(is_present=False)):
        reception.handle(event, 0)
    assert line_of(reception, "ada").text == "ada   not connected"
    assert line_of(reception, "ada").style is Style.ERROR
    assert line_of(reception, "/odom")
    reception.handle(presence(boot="1"), 1)
    assert line_of(reception, "ada").style is Style.HEADING


def test_two_robots_of_one_name_are_said_until_one_leaves() -> None:
    reception = Reception([])
    for boot in ("0", "1", "1"):
        reception.handle(presence(boot=boot), 0)
    line = line_of(reception, "ada")
    assert (line.text, line.style) == ("ada   0.0 KB/s of messages   2 robots have this name", Style.WARN)
    reception.handle(presence(boot="0", is_present=False), 1)
    assert line_of(reception, "ada").text == "ada   0.0 KB/s of messages"


def test_each_robot_has_a_table_of_its_own_by_name() -> None:
    reception = Reception([])
    for robot in ("bob", "ada"):
        reception.handle(presence(robot), 0)
        reception.handle(message(robot=robot), 0)
    headings = [line for line in shown(reception) if "KB/s of messages" in line]
    assert [line.split()[0] for line in headings] == ["ada", "bob"]
    assert sum(line.startswith("/odom") for line in shown(reception)) == 2


def test_a_narrow_terminal_gets_lines_that_fit_and_names_cannot_move_the_cursor() -> None:
    reception = Reception([])
    hostile = replace(ODOM, topic="/\x1b[2J" + "x" * 200, type_name="a\r\nb")
    for event in (presence(), said(hostile), message(hostile)):
        reception.handle(event, 0)
    lines = reception_lines(reception, 80)
    assert all(line.text.isprintable() and len(line.text) <= 80 for line in lines)
