# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What arrives over a link, as a client of the Foxglove WebSocket protocol gets it."""

from __future__ import annotations

import builtins
import io
import itertools
import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from bags.bag_factory import CUSTOM_DEFINITION, CUSTOM_TYPE, IMAGE, START_NS, TYPES, cdr, message_of, odometry
from link.foxglove.foxglove_client import decoded_by_foxglove, foxglove_client
from link.zenoh.ends import until
from smarttestudo.domain.errors import MissingPackageError, PortError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.foxglove import open_foxglove_sink
from smarttestudo.link.foxglove.sink import FoxgloveSink

TEXT = "std_msgs/msg/String"
BEST_EFFORT = Qos(reliable=False, transient_local=False, depth=5)
IDL = "module robot_msgs { module msg { struct Gripper { double opening; boolean holds; }; }; };"
LATCHED = Qos(reliable=True, transient_local=True, depth=2)
ODOM = StreamInfo(topic="/odom", type_name="nav_msgs/msg/Odometry", qos=BEST_EFFORT)
GRIPPER = StreamInfo(topic="/gripper", type_name=CUSTOM_TYPE, qos=BEST_EFFORT, definition=CUSTOM_DEFINITION)


def words(content: str) -> bytes:
    return cdr(TEXT, message_of(TEXT, data=content))


def names_by(publisher: int) -> StreamInfo:
    return StreamInfo(topic="/names", type_name=TEXT, qos=LATCHED, publisher=publisher)


def take(sink: FoxgloveSink, stream: StreamInfo, payload: bytes, robot: str = "ada") -> None:
    sink.write(ReceivedMessage(robot=robot, stream=stream, payload=payload, offered_ns=1, age_ns=None))


@pytest.fixture
def sink() -> Iterator[FoxgloveSink]:
    """At a free port, by a clock that goes on by a nanosecond a message; it has nothing to say."""
    opened = open_foxglove_sink(0, pytest.fail, itertools.count(START_NS).__next__)
    yield opened
    opened.close()


def test_a_client_gets_each_topic_with_its_definition_and_the_bytes_of_the_robot(sink: FoxgloveSink) -> None:
    for stream in (ODOM, GRIPPER):
        sink.open("ada", stream)
    with foxglove_client(sink.port) as client:
        client.await_channels("/odom", "/gripper")
        # Once the topic that is latched brings something, the other is subscribed to as well.
        client.subscribe("/odom")
        sink.open("ada", names_by(0))
        take(sink, names_by(0), words("hall"))
        client.await_channels("/odom", "/gripper", "/names")
        client.subscribe("/names")
        client.await_messages(1)
        take(sink, ODOM, odometry(1.0, 2.0))
        assert client.await_messages(2)[1:] == [("/odom", START_NS + 1, odometry(1.0, 2.0))]
        odom, gripper = client.channels["/odom"], client.channels["/gripper"]
    assert (odom["encoding"], odom["schemaName"], odom["schemaEncoding"]) == (
        "cdr",
        "nav_msgs/msg/Odometry",
        "ros2msg",
    )
    assert "MSG: geometry_msgs/PoseWithCovariance" in odom["schema"]
    assert gripper["schema"] == CUSTOM_DEFINITION


def test_a_late_client_gets_the_last_messages_of_each_publisher_of_a_latched_topic(
    sink: FoxgloveSink,
) -> None:
    sent = [(0, "old hall"), (1, "yard"), (0, "hall"), (0, "new hall")]
    for publisher, content in sent:
        sink.open("ada", names_by(publisher))
        take(sink, names_by(publisher), words(content))
    sink.open("ada", ODOM)
    take(sink, ODOM, odometry(1.0, 2.0))
    with foxglove_client(sink.port) as client:
        client.await_channels("/names", "/odom")
        for topic in ("/odom", "/names"):
            client.subscribe(topic)
        assert client.await_messages(3) == [
            ("/names", START_NS + 1, words("yard")),
            ("/names", START_NS + 2, words("hall")),
            ("/names", START_NS + 3, words("new hall")),
        ]


def test_a_publisher_that_tells_no_definition_uses_that_of_another(sink: FoxgloveSink) -> None:
    defined = replace(GRIPPER, qos=LATCHED)
    held = cdr(CUSTOM_TYPE, message_of(CUSTOM_TYPE, opening=0.5))
    for stream in (defined, replace(defined, publisher=1, definition="")):
        sink.open("ada", stream)
        take(sink, stream, held)
    with foxglove_client(sink.port) as client:
        client.await_channels("/gripper")
        client.subscribe("/gripper")
        assert len(client.await_messages(2)) == 2
        assert client.channels["/gripper"]["schema"] == CUSTOM_DEFINITION


def test_a_definition_in_idl_is_announced_as_such(sink: FoxgloveSink) -> None:
    definition = f"{'=' * 80}\nIDL: {CUSTOM_TYPE}\n{IDL}"
    sink.open("ada", replace(GRIPPER, definition=definition))
    with foxglove_client(sink.port) as client:
        client.await_channels("/gripper")
    channel = client.channels["/gripper"]
    assert (channel["schemaEncoding"], channel["schema"]) == ("ros2idl", definition)


def test_a_topic_with_another_type_is_announced_anew(sink: FoxgloveSink) -> None:
    sink.open("ada", ODOM)
    with foxglove_client(sink.port) as client:
        client.await_type("/odom", ODOM.type_name)
        changed = StreamInfo(topic="/odom", type_name=TEXT, qos=LATCHED)
        sink.open("ada", changed)
        take(sink, ODOM, odometry(1.0, 2.0))
        take(sink, changed, words("now a text"))
        client.await_type("/odom", TEXT)
        client.subscribe("/odom")
        assert [payload for _, _, payload in client.await_messages(1)] == [words("now a text")]


def test_topics_have_the_robots_name_as_soon_as_there_are_two(sink: FoxgloveSink) -> None:
    sink.open("ada", names_by(0))
    take(sink, names_by(0), words("hall"))
    with foxglove_client(sink.port) as client:
        client.await_channels("/names")
        sink.open("bob", names_by(0))
        take(sink, names_by(0), words("yard"), "bob")
        client.await_channels("/ada/names", "/bob/names")
        for topic in ("/ada/names", "/bob/names"):
            client.subscribe(topic)
        got = {(topic, payload) for topic, _, payload in client.await_messages(2)}
    assert got == {("/ada/names", words("hall")), ("/bob/names", words("yard"))}


def test_who_subscribes_before_the_sdk_takes_subscriptions_gets_the_topic_announced_anew(
    sink: FoxgloveSink,
) -> None:
    with foxglove_client(sink.port) as client:
        sink.open("ada", ODOM)
        client.await_channels("/odom")
        # Numbers count up, so the next is known here as early as the SDK announces it: before it is ready.
        early = client.channels["/odom"]["id"] + 1
        client.subscribe_to(early)
        client.await_status("Unknown channel")
        sink.open("ada", GRIPPER)
        sink.open("ada", names_by(0))
        client.await_channels("/odom", "/gripper", "/names")
        assert client.channels["/gripper"]["id"] == early
        take(sink, names_by(0), words("hall"))
        client.await_announced("/gripper", not_as=early)
        client.subscribe("/gripper")
        client.subscribe("/names")
        client.await_messages(1)
        take(sink, GRIPPER, b"closed")
        assert client.await_messages(2)[1][0] == "/gripper"


def test_a_type_that_nobody_defines_is_said_once_and_costs_its_topic_only() -> None:
    said: list[str] = []
    sink = open_foxglove_sink(0, said.append, lambda: START_NS)
    odd = StreamInfo(topic="/odd", type_name="acme_msgs/msg/Odd", qos=LATCHED)
    for _ in range(2):
        sink.open("ada", odd)
        take(sink, odd, b"\x00\x01\x00\x00\x00")
    sink.open("ada", ODOM)
    with foxglove_client(sink.port) as client:
        client.await_channels("/odom")
    sink.close()
    assert said == [
        "/odd: not served to Foxglove, because nobody defines acme_msgs/msg/Odd; "
        "install the package of that type on ada"
    ]


def test_a_port_that_is_taken_is_one_line_with_a_remedy(sink: FoxgloveSink) -> None:
    with pytest.raises(PortError) as refused:
        open_foxglove_sink(sink.port, pytest.fail, lambda: START_NS)
    line = str(refused.value)
    assert line.startswith(f"127.0.0.1:{sink.port}: error: the Foxglove server cannot listen there: ")
    assert "Address already in use" in line
    assert line.endswith("; give another port, or end what listens there")


def test_without_the_sdk_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    usual: Callable[..., Any] = builtins.__import__

    def without_foxglove(name: str, *rest: Any, **named: Any) -> Any:
        if name.partition(".")[0] == "foxglove":
            raise ModuleNotFoundError(f"No module named {name!r}", name="foxglove")
        return usual(name, *rest, **named)

    monkeypatch.delitem(sys.modules, "smarttestudo.link.foxglove.sink", raising=False)
    monkeypatch.setattr(builtins, "__import__", without_foxglove)
    with pytest.raises(MissingPackageError, match=r"foxglove-sdk; .* -m pip install '\.\[link\]'"):
        open_foxglove_sink(0, pytest.fail, lambda: START_NS)


def test_foxgloves_own_packages_decode_odometry_and_an_image(sink: FoxgloveSink) -> None:
    definition, _ = TYPES.generate_msgdef(IMAGE.type_name, ros_version=2)
    image = StreamInfo(topic="/image", type_name=IMAGE.type_name, qos=LATCHED, definition=definition)
    odom = StreamInfo(topic="/odom", type_name=ODOM.type_name, qos=LATCHED)
    pixels = np.arange(24, dtype=np.uint8)
    estimate = message_of(IMAGE.type_name, height=2, width=4, step=12, encoding="rgb8", data=pixels)
    for stream, payload in ((odom, odometry(1.5, -2.0)), (image, cdr(IMAGE.type_name, estimate))):
        sink.open("ada", stream)
        take(sink, stream, payload)
    decoded = decoded_by_foxglove(sink.port, "/odom", "/image")
    assert decoded["/odom"]["message"]["pose"]["pose"]["position"] == {"x": 1.5, "y": -2, "z": 0}
    shown = decoded["/image"]["message"]
    assert (shown["height"], shown["width"], shown["encoding"]) == (2, 4, "rgb8")
    assert shown["data"] == pixels.tolist()
    assert decoded["/image"]["schemaEncoding"] == "ros2msg"


@pytest.mark.parametrize("protocols", [["foxglove.websocket.v1"], []])
def test_a_client_of_the_old_protocol_is_refused_and_it_is_said_once_which_clients_work(
    protocols: list[str],
) -> None:
    said: list[str] = []
    with logged() as text:
        sink = open_foxglove_sink(0, said.append, itertools.count(START_NS).__next__)
        offered = [Subprotocol(name) for name in protocols] or None
        for _ in range(2):
            with pytest.raises(InvalidStatus), connect(f"ws://127.0.0.1:{sink.port}", subprotocols=offered):
                pass
            until(lambda: bool(said))
        sink.close()
    assert said == [
        "Foxglove: a client was refused, as it does not offer the protocol foxglove.sdk.v1; "
        "use the current Foxglove app, or Lichtblick 1.22 or newer"
    ]
    assert "handshake" not in text.getvalue()


@contextmanager
def logged() -> Iterator[io.StringIO]:
    """What any library logs during the block."""
    text = io.StringIO()
    handler = logging.StreamHandler(text)
    logging.getLogger().addHandler(handler)
    try:
        yield text
    finally:
        logging.getLogger().removeHandler(handler)


def test_a_client_that_offers_the_old_protocol_beside_the_new_one_is_served() -> None:
    sink = open_foxglove_sink(0, pytest.fail, itertools.count(START_NS).__next__)
    offered = [Subprotocol("foxglove.websocket.v1"), Subprotocol("foxglove.sdk.v1")]
    with connect(f"ws://127.0.0.1:{sink.port}", subprotocols=offered) as connection:
        assert connection.subprotocol == "foxglove.sdk.v1"
    sink.close()
