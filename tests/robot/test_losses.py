# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What topics lose before they can be relayed: from when on, how much, why, and how often that is said."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.robot import Endpoint
from smarttestudo.domain.status import LossBeforeRelay
from smarttestudo.robot.losses import LARGE_BYTES, PAUSE_NS, TOO_SLOW, SourceLoss, TopicLosses

SECOND = 1_000_000_000
SETTING = "FASTDDS_BUILTIN_TRANSPORTS='DEFAULT?sockets_size=8MB'"
IMAGE_BYTES = 921_652


class Subscription:
    """Nothing came of it yet; ``sent`` is ``None`` where nothing is numbered."""

    sent: int | None = 0
    dropped = 0

    def close(self) -> None: ...

    def goes_on(self, sent: int, lost: int = 0) -> None:
        assert self.sent is not None
        self.sent += sent
        self.dropped += lost


class Log:
    def __init__(self) -> None:
        self.lines: list[str] = []

    @property
    def numbers(self) -> list[str]:
        return [line[: line.index(" messages")] for line in self.lines]


def losses_of(topic: str, log: Log, *publishers: Endpoint, setting: str | None = SETTING) -> TopicLosses:
    return TopicLosses(topic, log.lines.append, lambda: publishers, setting)


def loss_of(losses: TopicLosses) -> SourceLoss:
    loss = losses.loss()
    assert loss is not None
    return loss


def begun(subscription: Subscription, sent: int = 1) -> Subscription:
    subscription.goes_on(sent)
    return subscription


def camera(node: str = "/camera", **other: Any) -> Endpoint:
    usual: dict[str, Any] = {"reliable": False, "transient_local": False, "is_local": True}
    return Endpoint(node=node, type_name="sensor_msgs/msg/Image", **{**usual, **other})


def test_losses_are_said_at_once_and_then_no_more_than_every_ten_seconds() -> None:
    log, subscription = Log(), begun(Subscription())
    losses = losses_of("/scan", log)
    for second in range(25):
        subscription.goes_on(10, 2 if second else 0)
        losses.measure(subscription, second * SECOND)
    assert log.numbers == ["/scan: lost 2", "/scan: lost 20", "/scan: lost 20"]
    assert PAUSE_NS == 10 * SECOND


def test_what_was_lost_last_is_said_when_a_topic_is_no_longer_subscribed_to_and_at_the_end() -> None:
    log, scan, later = Log(), begun(Subscription()), begun(Subscription())
    losses = losses_of("/scan", log)
    losses.measure(scan, 0)
    scan.goes_on(10, 5)
    losses.measure(scan, SECOND)
    scan.goes_on(10, 2)
    losses.measure(later, 2 * SECOND)
    later.goes_on(10, 1)
    losses.close()
    assert log.numbers == ["/scan: lost 5", "/scan: lost 2", "/scan: lost 1"]


def test_what_was_lost_is_counted_from_the_start_over_all_subscriptions_of_a_topic() -> None:
    scan, later, unnumbered = (begun(Subscription()) for _ in range(3))
    losses = losses_of("/scan", Log())

    def lost() -> int | None:
        loss = losses.loss()
        return None if loss is None else loss.messages

    losses.measure(scan, 0)
    scan.goes_on(10, 7)
    assert lost() == 7
    losses.measure(None, SECOND)
    assert lost() == 7
    losses.measure(later, 2 * SECOND)
    later.goes_on(10, 1)
    assert lost() == 8
    unnumbered.sent = None
    losses = losses_of("/tf", Log())
    losses.measure(unnumbered, 0)
    assert lost() is None, "nobody knows of messages without numbers"


Seconds = st.lists(st.tuples(st.integers(1, 50), st.integers(0, 49)), max_size=40)
"""How many messages are sent in each, and how many of them are lost, at most one less."""


@given(silent_s=st.integers(0, 5), start=st.tuples(st.integers(1, 50), st.integers(0, 49)), seconds=Seconds)
def test_all_that_is_lost_after_a_look_that_found_a_first_message_is_said_and_nothing_before(
    silent_s: int, start: tuple[int, int], seconds: list[tuple[int, int]]
) -> None:
    log, subscription = Log(), Subscription()
    losses = losses_of("/scan", log)
    for second in range(silent_s):
        losses.measure(subscription, second * SECOND)
    subscription.goes_on(start[0], min(start[1], start[0] - 1))
    losses.measure(subscription, silent_s * SECOND)
    assert log.lines == [], "what is lost while the run starts is none of the robot's"
    lost = 0
    for second, (sent, at_most) in enumerate(seconds, start=silent_s + 1):
        subscription.goes_on(sent, min(at_most, sent - 1))
        lost += min(at_most, sent - 1)
        losses.measure(subscription, second * SECOND)
    assert loss_of(losses).messages == lost
    losses.close()
    assert sum(int(line.split()[2]) for line in log.lines) == lost


@pytest.mark.parametrize(
    ("lost_of_15", "is_state"), [(0, False), (0.5, False), (1, True), (3, True), (9, True), (14, True)]
)
def test_a_topic_is_lost_before_relay_while_more_than_a_twentieth_of_it_is(
    lost_of_15: float, is_state: bool
) -> None:
    log, subscription = Log(), begun(Subscription())
    losses = losses_of("/image", log, camera())
    losses.size_bytes = IMAGE_BYTES
    losses.measure(subscription, 0)
    for second in range(1, 31):
        subscription.goes_on(15, round(lost_of_15 * second) - round(lost_of_15 * (second - 1)))
        losses.measure(subscription, second * SECOND)
    loss = loss_of(losses)
    assert loss.share == pytest.approx(lost_of_15 / 15, abs=0.01)
    assert (loss.state is not None) == is_state
    for second in range(31, 45):
        subscription.goes_on(15)
        losses.measure(subscription, second * SECOND)
    assert loss_of(losses).state is None, "the camera has what it needs now"
    assert loss_of(losses).share == 0


@pytest.mark.parametrize(
    ("size_bytes", "reliable", "lost", "must_work"),
    [
        (IMAGE_BYTES, False, 9, [True] * 8),
        (IMAGE_BYTES, False, 0, [True] * 3 + [False] * 5),
        (1000, False, 9, [False] * 8),
        (IMAGE_BYTES, True, 9, [False] * 8),
    ],
)
def test_what_may_lose_for_want_of_memory_is_received_whole_until_it_is_known_that_it_does_not(
    size_bytes: int, reliable: bool, lost: int, must_work: list[bool]
) -> None:
    subscription = begun(Subscription())
    losses = losses_of("/image", Log(), camera(reliable=reliable))
    losses.size_bytes = size_bytes
    found = []
    for second in range(8):
        losses.measure(subscription, second * SECOND)
        found.append(losses.may_lack_room)
        subscription.goes_on(15, lost)
    assert found == must_work


def test_a_camera_that_left_is_still_the_one_that_lacked_room() -> None:
    log, subscription, publishers = Log(), begun(Subscription()), [camera()]
    losses = TopicLosses("/image", log.lines.append, lambda: publishers, SETTING)
    losses.size_bytes = IMAGE_BYTES
    for second in range(3):
        losses.measure(subscription, second * SECOND)
        subscription.goes_on(15, 9)
    publishers.clear()
    losses.close()
    assert [line.partition("; ")[2].partition(" start ")[2][:7] for line in log.lines] == ["/camera", ""]


def test_one_hitch_is_no_state() -> None:
    subscription = begun(Subscription())
    losses = losses_of("/battery", Log())
    for second in range(10):
        subscription.goes_on(1, 0)
        losses.measure(subscription, second * SECOND)
    subscription.goes_on(2, 1)
    losses.measure(subscription, 10 * SECOND)
    assert loss_of(losses).state is None


@pytest.mark.parametrize(
    ("publishers", "size_bytes", "setting", "named"),
    [
        ([camera()], IMAGE_BYTES, SETTING, "/camera"),
        ([camera()], 200_000, SETTING, "/camera"),
        ([camera()], LARGE_BYTES, SETTING, "/camera"),
        ([camera("/left"), camera("/right")], IMAGE_BYTES, SETTING, "/left and /right"),
        ([camera("/left"), camera("/right", is_local=False)], IMAGE_BYTES, SETTING, "/left"),
        ([camera("/left"), camera("/right", reliable=True)], IMAGE_BYTES, SETTING, "/left"),
        ([camera()], LARGE_BYTES - 1, SETTING, None),
        ([camera()], None, SETTING, None),
        ([camera(is_local=False)], IMAGE_BYTES, SETTING, None),
        ([camera(reliable=True)], IMAGE_BYTES, SETTING, None),
        ([camera()], IMAGE_BYTES, None, None),
        ([], IMAGE_BYTES, SETTING, None),
    ],
)
def test_who_has_too_little_shared_memory_is_named_with_what_to_set_and_else_the_machine_is_too_slow(
    publishers: list[Endpoint], size_bytes: int | None, setting: str | None, named: str | None
) -> None:
    log, subscription = Log(), begun(Subscription())
    losses = losses_of("/image", log, *publishers, setting=setting)
    if size_bytes is not None:
        losses.size_bytes = size_bytes
    for second in range(25):
        losses.measure(subscription, second * SECOND)
        subscription.goes_on(15, 9)
    state = loss_of(losses).state
    assert isinstance(state, LossBeforeRelay)
    assert state.percent == pytest.approx(60)
    assert (state.remedy == TOO_SLOW) == (named is None)
    assert named is None or f" start {named} with {SETTING}" in state.remedy
    assert [line.partition("relayed")[2] for line in log.lines] == [f"; {state.remedy}", "", ""], "once"
