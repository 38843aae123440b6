# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Status, top, diagnostics and log say of a topic that its rate is not what is shown of it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from pacing.bitstreams import IDR, NON_IDR_P, PPS, SPS, compressed_image, compressed_video, nal
from robot.status.status_driver import StatusDriver
from smarttestudo.cli.top_table import SortKey, topic_lines
from smarttestudo.domain.record import from_json, to_json
from smarttestudo.domain.robot import DiagnosticLevel
from smarttestudo.domain.status import RuntimeStatus, ThinningDoubt
from smarttestudo.domain.texts import SayOnce
from smarttestudo.robot.diagnostics import diagnostics
from smarttestudo.robot.status import doubt_lines

KEY, DIFFERENCE = nal(SPS, PPS, IDR), nal(NON_IDR_P)
VIDEO, IMAGE = "foxglove_msgs/msg/CompressedVideo", "sensor_msgs/msg/CompressedImage"
PATCHES = "map_msgs/msg/OccupancyGridUpdate"


def watched(rate: str, type_name: str, payload: Callable[[int], bytes], seconds: int) -> RuntimeStatus:
    """The status after so many seconds of thirty messages a second."""
    run = StatusDriver(
        rules=f"begin SetFrequency /t {rate} end", source_hz={}, links={"/t": {"type_name": type_name}}
    )
    run.driver.source("/t", type_name=type_name)
    number = 0
    for second in range(1, seconds + 1):
        while number < 30 * second:
            run.driver.send("/t", number * 10**9 // 30, payload(number))
            number += 1
        run.driver.wait_until(second * 10**9)
        status = run.look()
    return status


def group_of(frames: int, make: Callable[..., bytes] = compressed_video) -> Callable[[int], bytes]:
    return lambda number: make(DIFFERENCE if number % frames else KEY, "h264")


@pytest.mark.parametrize(
    ("rate", "type_name", "payload", "doubt"),
    [
        ("10", VIDEO, group_of(30), None),
        ("10", IMAGE, group_of(30, compressed_image), None),
        ("10", VIDEO, lambda _: compressed_video(b"\xff", "own"), ThinningDoubt.NO_KEY_FRAME),
        ("10", IMAGE, lambda _: compressed_image(DIFFERENCE, "h264"), ThinningDoubt.NO_KEY_FRAME),
        ("Full", VIDEO, lambda _: compressed_video(b"\xff", "own"), None),
        ("10", VIDEO, group_of(100_000), ThinningDoubt.KEY_FRAME_OVERDUE),
        ("Full", VIDEO, group_of(100_000), None),
        ("30", VIDEO, group_of(100_000), None),
        ("2", PATCHES, lambda _: b"\0\1\0\0", ThinningDoubt.PATCHES),
        ("Full", PATCHES, lambda _: b"\0\1\0\0", None),
        ("Off", PATCHES, lambda _: b"\0\1\0\0", None),
        ("40", PATCHES, lambda _: b"\0\1\0\0", None),
        ("2", "nav_msgs/msg/OccupancyGrid", lambda _: b"\0\1\0\0", None),
    ],
)
def test_a_status_says_why_a_topic_is_not_shown_as_its_rate_says(
    rate: str, type_name: str, payload: Callable[[int], bytes], doubt: ThinningDoubt | None
) -> None:
    status = watched(rate, type_name, payload, 25)
    topic = status.topics["/t"]
    assert topic.doubt is doubt
    assert topic.keeps_rate
    assert from_json(RuntimeStatus, to_json(status)).topics["/t"].doubt is doubt
    (told,) = (one for one in diagnostics(status) if one.name == "/testudo/t")
    shown = "\n".join(line.text for line in topic_lines(status, SortKey.TOPIC))
    if doubt is None:
        assert told.level is DiagnosticLevel.OK
        return
    assert (told.level, told.message) == (DiagnosticLevel.WARN, f"{doubt.value}: {doubt.details}")
    assert doubt.value in shown


class Log:
    def __init__(self) -> None:
        self.lines: list[str] = []

    def warning(self, text: str) -> None:
        self.lines.append(text)

    info = error = warning


def test_the_log_says_each_doubt_once() -> None:
    log = Log()
    say = SayOnce(log.warning)
    status = watched("2", PATCHES, lambda _: b"\0\1\0\0", 3)
    for _ in range(3):
        for line in doubt_lines(status.topics):
            say(line)
    assert log.lines == [f"/t: {ThinningDoubt.PATCHES.value}: {ThinningDoubt.PATCHES.details}"]
