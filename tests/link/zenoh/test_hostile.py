# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What others put on the keys of a link costs nothing but counts."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
import zenoh
import zstandard

from link.protocol.whole_chunks import WholeChunks
from link.zenoh.ends import ODOM, Reader, free_endpoint, operator_end, robot_end, stranger_at, until
from smarttestudo.link.protocol.chunks import CONTROL_STREAM, Acknowledgement
from smarttestudo.link.protocol.keys import Boot, new_boot
from smarttestudo.link.protocol.messages import CONTROL, REPORTS, Announcement, Report
from smarttestudo.link.protocol.receiver import ReceiverCounts
from smarttestudo.link.zenoh.operator_end import OperatorEnd
from smarttestudo.link.zenoh.robot_end import RobotEnd

pytestmark = pytest.mark.full

RANDOM = random.Random(7)


def counts(operator: OperatorEnd, boot: Boot) -> ReceiverCounts:
    """What arrived of one robot."""
    return operator.counts().get(boot, ReceiverCounts())


def still_works(robot: RobotEnd, reader: Reader) -> None:
    """Messages go on arriving."""
    publisher, payload = robot.advertise(ODOM), RANDOM.randbytes(50)
    until(lambda: payload in reader.payloads(), lambda: publisher.publish(payload))
    publisher.close()


def test_what_is_malformed_instead_of_chunks_is_counted() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot, stranger_at(endpoint) as other:
        reader, boot, chunks = Reader(operator), new_boot("liar", 1), WholeChunks(is_kept=True)
        still_works(robot, reader)
        bomb = zstandard.ZstdCompressor().compress(bytes(100_000_000))
        strange = [b"", b"\x01", *(RANDOM.randbytes(size) for size in (10, 100, 2_000, 60_000) * 20)]
        # A random first byte that is a version of ours would make it a chunk.
        strange = [b"\x00" + data for data in strange]
        for data in strange:
            other.put(robot.boot.data_key, data, congestion_control=zenoh.CongestionControl.BLOCK)
        until(lambda: counts(operator, robot.boot).malformed == len(strange), reader.read)
        no_topic = CONTROL.to_bytes(Announcement(stream=1, info=replace(ODOM, topic="x y")))
        strange = [
            chunks.of(CONTROL_STREAM, bomb, is_compressed=True),
            chunks.of(CONTROL_STREAM, RANDOM.randbytes(100), is_compressed=True),
            chunks.of(CONTROL_STREAM, no_topic),
            chunks.of(CONTROL_STREAM, b"[" * 100_000),
            chunks.of(77, b"of no stream"),
        ]
        with other.liveliness().declare_token(boot.key):
            until(lambda: boot in operator.counts(), reader.read)
            for data in strange:
                other.put(boot.data_key, data, congestion_control=zenoh.CongestionControl.BLOCK)
            until(lambda: counts(operator, boot).malformed == len(strange), reader.read)
            still_works(robot, reader)


def test_what_is_malformed_instead_of_reports_is_counted() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot, stranger_at(endpoint) as other:
        reader = Reader(operator)
        still_works(robot, reader)
        before = robot.counts()
        strange = [b"", b"\xff" * 40, *(b"\x00" + RANDOM.randbytes(size) for size in (1, 30, 900_000))]
        report = REPORTS.to_bytes(Report(receiver=1, received=Acknowledgement(session=1, received_bytes=0)))
        strange += [report + b"\0", report + b"[" * 200_000, report[:-1]]
        for data in strange:
            other.put(robot.boot.report_key, data, congestion_control=zenoh.CongestionControl.BLOCK)
        until(lambda: robot.malformed == len(strange), reader.read)
        assert robot.counts().keys() == before.keys()
        still_works(robot, reader)
