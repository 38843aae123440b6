# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What every data path promises, and what each adds where it says so."""

from __future__ import annotations

import os
import resource
import select
import sys
import time
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import DataPath, DataPathKind, Payload, Publisher, Qos, Robot
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.ros.rcl.bindings import KEPT_BUFFERS, RclLibrary
from smarttestudo.robot.ros.rcl.subscription import RclSource
from smarttestudo.robot.ros.rcl.wake_ups import MOST_AT_ONCE

pytestmark = pytest.mark.contract

only_librcl = pytest.mark.parametrize("robot", [DataPathKind.RCL], ids=["rcl"], indirect=True)

TIMEOUT_S = 120.0
TEXT = "std_msgs/msg/String"
EMPTY = "std_msgs/msg/Empty"
IMAGE = "sensor_msgs/msg/Image"
RELIABLE = Qos(reliable=True, transient_local=False, depth=200)
LATCHED = Qos(reliable=True, transient_local=True, depth=5)
NO_MESSAGE = b"\x00\x01\x00\x00\x00"
# It announces 255 characters, and no padding makes them come.
NO_STRING = b"\x00\x01\x00\x00\xff\x00\x00\x00"


@pytest.fixture(params=[DataPathKind.FAST, DataPathKind.RCL, DataPathKind.RCLPY], ids=lambda kind: kind.value)
def robot(request: pytest.FixtureRequest, in_domain: None) -> Iterator[Robot]:
    with open_robot(data_path=request.param) as opened:
        yield opened


class Heard:
    """What came of one topic."""

    def __init__(self) -> None:
        self.payloads: list[Payload] = []
        self.publishers: list[Hashable] = []

    def __call__(self, payload: Payload, publisher: Hashable) -> None:
        self.payloads.append(payload)
        self.publishers.append(publisher)

    def has_count(self, count: int) -> bool:
        return len(self.payloads) == count

    @property
    def copies(self) -> list[bytes]:
        return [without_padding(payload[:]) for payload in self.payloads]


def text(content: str) -> bytes:
    """A std_msgs/String as CDR."""
    data = content.encode() + b"\x00"
    return b"\x00\x01\x00\x00" + len(data).to_bytes(4, "little") + data


def without_padding(payload: bytes) -> bytes:
    """A std_msgs/String as it was sent: Cyclone DDS makes all payloads a multiple of four bytes."""
    if os.environ.get("RMW_IMPLEMENTATION") != "rmw_cyclonedds_cpp":
        return payload
    end = 8 + int.from_bytes(payload[4:8], "little")
    is_padded = len(payload) % 4 == 0 and len(payload) - 3 <= end and not any(payload[end:])
    return payload[:end] if is_padded else payload


CHANGING = text("while it changes over")


def wait_until(robot: Robot, condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end_s, "nothing came in time"
        robot.wait(None, 0.1)


def test_messages_of_any_size_arrive_as_they_were_sent_and_in_order(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    publisher = path.advertise("/words", TEXT, LATCHED)
    path.subscribe("/words", TEXT, LATCHED, heard)
    sent = [text("x" * size) for size in (0, 1, 6_220_800, 100)]
    for payload in sent:
        publisher.publish(payload)
    wait_until(robot, lambda: len(heard.payloads) == len(sent))
    assert all(len(payload) == len(payload[:]) for payload in heard.payloads)
    assert heard.copies == sent
    assert heard.payloads[3][4:8] == sent[3][4:8]


def test_what_is_held_never_changes_while_other_messages_come(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    publisher = path.advertise("/words", TEXT, RELIABLE)
    path.subscribe("/words", TEXT, RELIABLE, heard)
    sent = [text(f"message {number}") for number in range(100)]
    for count, payload in enumerate(sent, 1):
        publisher.publish(payload)
        wait_until(robot, partial(heard.has_count, count))
    assert heard.copies == sent


def test_a_topic_that_always_has_more_starves_no_other(robot: Robot) -> None:
    path, heard = robot.data_path, [Heard(), Heard(), Heard()]
    publishers = [path.advertise(f"/words{number}", TEXT, RELIABLE) for number in range(len(heard))]
    for number, one in enumerate(heard):
        path.subscribe(f"/words{number}", TEXT, RELIABLE, one)
        publish_and_await(robot, publishers[number], one, "hello")
    for _ in range(100):
        publishers[0].publish(text("more"))
    for publisher in publishers[1:]:
        publisher.publish(text("to be heard"))
    for number in range(20):
        robot.wait(None, 0.1 + number / 1000)
    assert [one.copies[1:] for one in heard[1:]] == [[text("to be heard")]] * 2


def test_what_came_can_be_published_as_it_is(robot: Robot) -> None:
    path, relayed = robot.data_path, Heard()
    source = path.advertise("/words", TEXT, LATCHED)
    publisher = path.advertise("/testudo/words", TEXT, LATCHED)
    path.subscribe("/testudo/words", TEXT, LATCHED, relayed)
    path.subscribe("/words", TEXT, LATCHED, lambda payload, _: publisher.publish(payload))
    source.publish(text("to the operator"))
    wait_until(robot, lambda: bool(relayed.payloads))
    assert relayed.copies == [text("to the operator")]


def test_qos_is_what_was_asked_for_and_late_subscribers_get_what_is_latched(robot: Robot) -> None:
    path, late = robot.data_path, Heard()
    best_effort = Qos(reliable=False, transient_local=False)
    publisher = path.advertise("/latched", TEXT, LATCHED)
    path.advertise("/best_effort", TEXT, best_effort)
    publisher.publish(text("map"))
    path.subscribe("/latched", TEXT, LATCHED, late)
    wait_until(robot, lambda: bool(late.payloads) and bool(robot.publishers("/best_effort")))
    (latched,) = robot.publishers("/latched")
    (plain,) = robot.publishers("/best_effort")
    assert late.copies == [text("map")]
    assert (latched.reliable, latched.transient_local) == (True, True)
    assert (plain.reliable, plain.transient_local) == (False, False)


def test_publishers_are_told_apart_where_the_path_says_so(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    publishers = [path.advertise("/words", TEXT, LATCHED) for _ in range(2)]
    path.subscribe("/words", TEXT, LATCHED, heard)
    for publisher in (*publishers, *publishers):
        publisher.publish(text("hello"))
    wait_until(robot, lambda: len(heard.publishers) == 4)
    if path.identifies_publishers:
        assert len(set(heard.publishers)) == 2
        assert all(heard.publishers.count(publisher) == 2 for publisher in heard.publishers)
    else:
        assert set(heard.publishers) == {None}


def test_a_topic_can_be_closed_and_opened_again_with_another_type(robot: Robot) -> None:
    path, closed, heard = robot.data_path, Heard(), Heard()
    first = path.advertise("/changing", TEXT, LATCHED)
    subscription = path.subscribe("/changing", TEXT, LATCHED, closed)
    subscription.close()
    first.publish(text("nobody hears this"))
    first.close()
    second = path.advertise("/changing", EMPTY, LATCHED)
    path.subscribe("/changing", EMPTY, LATCHED, heard)
    second.publish(NO_MESSAGE)
    wait_until(robot, lambda: bool(heard.payloads))
    assert heard.copies[-1][:4] == NO_MESSAGE[:4]
    assert closed.payloads == []


def test_bytes_that_are_no_message_pass_but_do_not_decode(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    publisher = path.advertise("/words", TEXT, LATCHED)
    path.subscribe("/words", TEXT, LATCHED, heard)
    publisher.publish(NO_STRING)
    publisher.publish(text("good"))
    wait_until(robot, lambda: len(heard.payloads) == 2)
    with pytest.raises(RosError, match="/words"):
        path.decode("/words", TEXT, heard.payloads[0])
    message = path.decode("/words", TEXT, heard.payloads[1])
    assert getattr(message, "data", None) == "good"


def test_a_type_that_is_not_installed_is_named(robot: Robot) -> None:
    for open_topic in (
        lambda: robot.data_path.advertise("/new", "new_msgs/msg/New", RELIABLE),
        lambda: robot.data_path.subscribe("/new", "new_msgs/msg/New", RELIABLE, Heard()),
    ):
        with pytest.raises(RosError, match="new_msgs/msg/New is not installed"):
            open_topic()


def test_a_type_that_was_built_for_another_python_is_named(
    robot: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "half_built" / "msg"
    package.mkdir(parents=True)
    generated = Path(sys.modules["std_msgs.msg._string"].__file__ or "").read_text("utf-8")
    (package / "_string.py").write_text(generated.replace("std_msgs", package.parent.name), "utf-8")
    for file in ("__init__.py", "msg/__init__.py", "half_built_s__rosidl_typesupport_c.cpython-27-arm.so"):
        (tmp_path / "half_built" / file).touch()
    monkeypatch.syspath_prepend(tmp_path)
    path, kind = robot.data_path, "half_built/msg/String"
    assert not path.knows(kind)
    uses: list[Callable[[], object]] = [
        lambda: path.advertise("/half", kind, RELIABLE),
        lambda: path.subscribe("/half", kind, RELIABLE, Heard()),
        lambda: path.decode("/half", kind, text("half")),
    ]
    for use in uses:
        with pytest.raises(RosError, match=r"/half: .*type half_built/msg/String cannot be used") as error:
            use()
        assert error.value.remedy == "build the ROS package half_built with the Python that runs SmartTestudo"


@only_librcl
def test_a_topic_for_which_no_descriptor_is_left_costs_itself_only(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    publisher = path.advertise("/words", TEXT, RELIABLE)
    subscribers = len(robot.own_subscribers("/words"))
    with no_more_descriptors(), pytest.raises(RosError, match=r"/words: .*open files.*ulimit -n"):
        path.subscribe("/words", TEXT, RELIABLE, heard)
    assert len(robot.own_subscribers("/words")) == subscribers
    path.subscribe("/words", TEXT, RELIABLE, heard)
    publish_and_await(robot, publisher, heard, "hello")


@contextmanager
def no_more_descriptors() -> Iterator[None]:
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    least_free = os.dup(0)
    os.close(least_free)
    resource.setrlimit(resource.RLIMIT_NOFILE, (least_free, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_a_burst_beyond_the_queue_costs_its_oldest_messages_and_their_number_is_known(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    short = Qos(reliable=True, transient_local=False, depth=5)
    publisher = path.advertise("/words", TEXT, short)
    subscription = path.subscribe("/words", TEXT, short, heard)
    publish_and_await(robot, publisher, heard, "first")
    for number in range(100):
        publisher.publish(text(f"burst {number}"))
    wait_until(robot, lambda: heard.copies[-1] == text("burst 99"))
    if subscription.sent is not None:
        assert subscription.sent == 101
        assert subscription.dropped == 101 - len(heard.payloads)
    assert heard.copies[-2] == text("burst 98")


@only_librcl
def test_buffers_go_back_when_nobody_holds_their_message_and_few_are_kept(robot: Robot) -> None:
    heard = Heard()
    publisher = robot.data_path.advertise("/words", TEXT, RELIABLE)
    subscription: Any = robot.data_path.subscribe("/words", TEXT, RELIABLE, heard)
    buffers = subscription._taker.buffers
    for number in range(50):
        publish_and_await(robot, publisher, heard, f"message {number}")
    assert buffers.lent == 50
    del heard.payloads[1:]
    assert buffers.lent == 1
    assert buffers.kept <= KEPT_BUFFERS
    subscription.close()
    assert heard.copies == [text("message 0")]
    heard.payloads.clear()
    assert (buffers.lent, buffers.kept) == (0, 0)


@only_librcl
def test_a_resting_inlet_skips_all_but_the_next_message_once_it_is_roused(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    needs_numbered_messages(path)
    publisher = path.advertise("/fast", TEXT, RELIABLE)
    subscription: Any = path.subscribe("/fast", TEXT, RELIABLE, heard)
    publish_and_await(robot, publisher, heard, "before")
    subscription.pause()
    change_over(robot, publisher)
    for number in range(50):
        publisher.publish(text(f"skipped {number}"))
    robot.wait(None, 0.1)
    assert heard.copies == [text("before"), CHANGING]
    subscription.arm()
    publish_and_await(robot, publisher, heard, "awaited")
    assert heard.copies == [text("before"), CHANGING, text("awaited")]
    assert (subscription.sent, subscription.dropped) == (53, 0)


@only_librcl
def test_what_a_late_wake_up_finds_at_a_resting_inlet_stays_where_it_is(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    needs_numbered_messages(path)
    publisher = path.advertise("/fast", TEXT, RELIABLE)
    subscription: Any = path.subscribe("/fast", TEXT, RELIABLE, heard)
    subscription.pause()
    change_over(robot, publisher)
    subscription.arm()
    publish_and_await(robot, publisher, heard, "awaited")
    publisher.publish(text("next"))
    assert not subscription.serve(MOST_AT_ONCE)
    assert heard.copies == [CHANGING, text("awaited")]
    subscription.arm()
    assert subscription.take_pending()
    assert heard.copies == [CHANGING, text("awaited"), text("next")]


@only_librcl
def test_the_last_word_before_a_silence_is_kept_while_resting(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    needs_numbered_messages(path)
    publisher = path.advertise("/fast", TEXT, RELIABLE)
    subscription: Any = path.subscribe("/fast", TEXT, RELIABLE, heard)
    subscription.pause()
    change_over(robot, publisher)
    for number in range(50):
        publisher.publish(text(f"skipped {number}"))
    subscription.arm()
    assert subscription.take_pending()
    assert not subscription.take_pending()
    assert heard.copies == [CHANGING, text("skipped 49")]


@only_librcl
def test_after_a_rest_every_message_is_received_again(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    needs_numbered_messages(path)
    publisher = path.advertise("/fast", TEXT, RELIABLE)
    subscription: Any = path.subscribe("/fast", TEXT, RELIABLE, heard)
    subscription.pause()
    change_over(robot, publisher)
    publisher.publish(text("the last word"))
    subscription.arm()
    subscription.resume()
    change_over(robot, publisher)
    burst = [text(f"burst {number}") for number in range(50)]
    for payload in burst:
        publisher.publish(payload)
    wait_until(robot, lambda: heard.copies[-1] == burst[-1])
    assert heard.copies == [CHANGING, text("the last word"), CHANGING, *burst]
    assert subscription.dropped == 0


def needs_numbered_messages(path: DataPath) -> None:
    """Skip what is promised only where the middleware numbers messages; Fast DDS must."""
    if os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps"):
        assert path.can_pause
    elif not path.can_pause:
        pytest.skip("this middleware does not number messages")


def change_over(robot: Robot, publisher: Publisher) -> None:
    """Let /fast have the first message through a new subscription, and close the old one."""
    wait_until(robot, lambda: len(robot.subscribers("/fast")) == 2)
    publisher.publish(CHANGING)
    wait_until(robot, lambda: len(robot.subscribers("/fast")) == 1)


def publish_and_await(robot: Robot, publisher: Publisher, heard: Heard, content: str) -> None:
    payload = text(content)
    publisher.publish(payload)
    wait_until(robot, lambda: payload in heard.copies)


@only_librcl
def test_a_message_that_was_announced_to_somebody_else_wakes_whoever_asks_next(robot: Robot) -> None:
    path, heard = robot.data_path, Heard()
    publisher = path.advertise("/words", TEXT, RELIABLE)
    source = path.subscribe("/words", TEXT, RELIABLE, heard)
    assert isinstance(source, RclSource)
    publish_and_await(robot, publisher, heard, "hello")
    subscription = source.hand_over(source.take_back)
    assert subscription is not None
    subscription.wake(wanted=True)
    os.eventfd_read(subscription.event_fd)
    publisher.publish(text("map"))
    assert select.select([subscription.event_fd], [], [], TIMEOUT_S)[0]
    next_fd = os.eventfd(0, os.EFD_NONBLOCK)
    RclLibrary().wake_on_message(subscription.pointer, next_fd)
    try:
        assert os.eventfd_read(next_fd)
    finally:
        os.close(next_fd)
