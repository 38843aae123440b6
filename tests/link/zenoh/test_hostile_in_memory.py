# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Strangers who speak on the keys of robots and operators, over a link in memory."""

from __future__ import annotations

import pytest
import zenoh

from link.protocol.whole_chunks import WholeChunks
from link.zenoh.ends import MAP, ODOM, Reader, free_endpoint, operator_end, robot_end, stranger_at, until
from link.zenoh.memory_zenoh import network
from link.zenoh.test_hostile import counts, still_works
from smarttestudo.domain.link import StreamInfo
from smarttestudo.link.protocol.chunks import CONTROL_STREAM, MAX_STREAMS, Acknowledgement
from smarttestudo.link.protocol.keys import MAX_ROBOTS, new_boot
from smarttestudo.link.protocol.messages import CONTROL, REPORTS, Announcement, Report
from smarttestudo.link.zenoh.arrivals import RobotPresence, StreamSaid

__all__ = ["network"]
pytestmark = pytest.mark.usefixtures("network")


def test_chunks_for_robots_that_are_not_there_are_counted() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, stranger_at(endpoint) as other:
        keys = (new_boot("nobody", 5).data_key, "testudo/*/*/data", "testudo/a/b/data")
        for key in keys:
            until(lambda: operator.unknown > 0, lambda: other.put(key, WholeChunks(is_kept=True).of(1, b"x")))  # noqa: B023
            operator.unknown = 0
        assert operator.wait(0) == []


def test_a_report_of_what_was_never_sent_changes_nothing() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot, stranger_at(endpoint) as other:
        heard: list[Report] = []
        listener = other.declare_subscriber(
            robot.boot.report_key, lambda sample: heard.append(REPORTS.from_bytes(sample.payload.to_bytes()))
        )
        reader = Reader(operator)
        still_works(robot, reader)
        until(lambda: any(report.received.session for report in heard), reader.read)
        listener.undeclare()
        own = heard[-1]
        for receiver in (own.receiver, own.receiver ^ 1):
            for session in (own.received.session, own.received.session + 1, 2**32 - 1):
                received = Acknowledgement(session=session, received_bytes=2**63)
                lie = Report(receiver=receiver, received=received, ages_ms={9**9: 1.0})
                other.put(robot.boot.report_key, REPORTS.to_bytes(lie))
        still_works(robot, reader)
        capacity = robot.state.capacity_kb_per_s
        assert capacity is None or capacity < 1e6
        assert robot.malformed == 0


@pytest.mark.full
def test_a_robot_that_names_a_million_topics_has_as_many_as_a_robot_may() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot, stranger_at(endpoint) as other:
        reader, boot, chunks = Reader(operator), new_boot("liar", 1), WholeChunks(is_kept=True)
        still_works(robot, reader)
        with other.liveliness().declare_token(boot.key):
            until(lambda: boot in operator.counts(), reader.read)
            for number in range(MAX_STREAMS + 2_000):
                info = StreamInfo(topic=f"/t{number}", type_name=MAP.type_name, qos=MAP.qos)
                said = CONTROL.to_bytes(Announcement(stream=1 + number % (MAX_STREAMS + 1_000), info=info))
                data = chunks.of(CONTROL_STREAM, said, number)
                other.put(boot.data_key, data, congestion_control=zenoh.CongestionControl.BLOCK)
            until(lambda: counts(operator, boot).malformed > 1_000, reader.read)
            named = {
                event.number
                for event in reader.read()
                if isinstance(event, StreamSaid) and event.robot == "liar"
            }
            assert max(named) < MAX_STREAMS
            still_works(robot, reader)
        gone = RobotPresence(robot="liar", boot=boot.number, is_present=False)
        until(lambda: gone in reader.read())


def test_only_so_many_robots_are_received_and_the_rest_is_said_once() -> None:
    endpoint, warnings = free_endpoint(), list[str]()
    with operator_end(endpoint, warn=warnings.append) as operator, stranger_at(endpoint) as other:
        reader = Reader(operator)
        boots = [new_boot(f"r{number}", number) for number in range(MAX_ROBOTS + 20)]
        tokens = [other.liveliness().declare_token(boot.key) for boot in boots]
        until(lambda: bool(warnings) and len(operator.counts()) == MAX_ROBOTS, reader.read)
        for token in tokens:
            token.undeclare()
        until(lambda: not operator.counts(), reader.read)
        # Those that are gone give way.
        with robot_end(endpoint) as robot:
            still_works(robot, reader)
        assert len(warnings) == 1
        assert str(MAX_ROBOTS) in warnings[0]


def test_two_robots_of_one_name_are_both_received_and_said_once() -> None:
    endpoint, warnings = free_endpoint(), list[str]()
    with (
        operator_end(endpoint, warn=warnings.append) as operator,
        robot_end(endpoint) as one,
        robot_end(endpoint) as two,
    ):
        reader = Reader(operator)
        publishers = [end.advertise(ODOM) for end in (one, two)]
        texts = (b"of one", b"of two")

        def publish() -> None:
            for publisher, text in zip(publishers, texts, strict=True):
                publisher.publish(text)

        until(lambda: set(reader.payloads()) == set(texts), publish)
        until(lambda: bool(warnings), reader.read)
        with robot_end(endpoint) as three:
            until(lambda: three.boot in operator.counts(), reader.read)
        assert warnings == [warnings[0]]
        assert "r1" in warnings[0]
        assert "--robot" in warnings[0]
